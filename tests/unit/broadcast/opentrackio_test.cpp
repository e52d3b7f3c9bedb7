// SPDX-License-Identifier: Apache-2.0
// OpenTrackIO datagrams against bytes of the reference sender (SMPTE's camdkit,
// test/python/parser), and samples read back as JSON and CBOR.
#include "extras/broadcast/packets/opentrackio.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace mixrig::stream {
namespace {

using nlohmann::json;

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

std::string hex(const std::vector<std::byte>& bytes) {
  std::string text;
  for (const std::byte b : bytes) {
    text += "0123456789abcdef"[std::to_integer<int>(b >> 4)];
    text += "0123456789abcdef"[std::to_integer<int>(b & std::byte{15})];
  }
  return text;
}

OpenTrackSample sample() {
  OpenTrackSample s;
  for (std::size_t i = 0; i < 16; ++i)
    s.sample_id[i] = static_cast<std::uint8_t>(17 * i), s.source_id[i] = 0xAB;
  s.source = 3, s.number = 12, s.time_ns = 1'750'000'000'040'000'001;
  s.status = "ok";
  s.angles = CameraAngles{0.1, -0.2, 0.3};
  s.position_m = {1.5, -2, 0.25};
  s.focal_length_mm = 24, s.offset_mm = {0.5, -0.25};
  s.zoom = 4012;
  s.sensor = {36, 20.25, 1280, 720};
  return s;
}

void expect_whole(const json& s) {
  EXPECT_EQ(s["protocol"], json::parse(R"({"name":"OpenTrackIO","version":[1,0,1]})"));
  EXPECT_EQ(s["sampleId"], "urn:uuid:00112233-4455-6677-8899-aabbccddeeff");
  EXPECT_EQ(s["sourceNumber"], 3);
  EXPECT_EQ(s["timing"]["mode"], "internal");
  EXPECT_EQ(s["timing"]["sequenceNumber"], 12);
  EXPECT_EQ(s["timing"]["sampleTimestamp"]["seconds"], 1'750'000'000);
  EXPECT_EQ(s["timing"]["sampleTimestamp"]["nanoseconds"], 40'000'001);
  EXPECT_EQ(s["tracker"]["status"], "ok");
  ASSERT_EQ(s["transforms"].size(), 1U);
  const json& t = s["transforms"][0];
  EXPECT_EQ(t["id"], "Camera");
  EXPECT_EQ(t["translation"], json::parse(R"({"x":1.5,"y":-2.0,"z":0.25})"));
  EXPECT_NEAR(t["rotation"]["pan"].get<double>(), 5.729577951, 1e-8);
  EXPECT_NEAR(t["rotation"]["tilt"].get<double>(), -11.459155903, 1e-8);
  EXPECT_NEAR(t["rotation"]["roll"].get<double>(), 17.188733854, 1e-8);
  EXPECT_EQ(s["lens"]["pinholeFocalLength"], 24);
  EXPECT_EQ(s["lens"]["projectionOffset"]["y"], -0.25);
  EXPECT_EQ(s["lens"]["rawEncoders"], json::parse(R"({"zoom":4012})"));
  const json& camera = s["static"]["camera"];
  EXPECT_EQ(camera["activeSensorPhysicalDimensions"]["height"], 20.25);
  EXPECT_EQ(camera["activeSensorResolution"]["width"], 1280);
}

TEST(OpenTrackIO, ASampleIsTheSameAsJsonAndAsCbor) {
  const auto text = opentrack_payload(sample(), OpenTrackEncoding::kJson);
  const auto* const begin = reinterpret_cast<const char*>(text.data());
  expect_whole(json::parse(begin, begin + text.size()));
  const auto cbor = opentrack_payload(sample(), OpenTrackEncoding::kCbor);
  const auto* const first = reinterpret_cast<const std::uint8_t*>(cbor.data());
  expect_whole(json::from_cbor(first, first + cbor.size()));
}

TEST(OpenTrackIO, WhatIsNotKnownIsNotSaid) {
  OpenTrackSample s;
  s.status = "lost: gap";
  const auto text = opentrack_payload(s, OpenTrackEncoding::kJson);
  const auto* const begin = reinterpret_cast<const char*>(text.data());
  const json read = json::parse(begin, begin + text.size());
  EXPECT_EQ(read["tracker"]["status"], "lost: gap");
  for (const char* key : {"transforms", "lens", "static"}) EXPECT_FALSE(read.contains(key)) << key;
}

TEST(OpenTrackIO, DatagramsAreThoseOfTheReferenceSender) {
  const auto text = bytes_of(R"({"a":1})"), part = bytes_of("xyz");
  EXPECT_EQ(hex(opentrack_datagram({OpenTrackEncoding::kJson, 0x1234, 0, true, text})),
            "4f54726b0001123400000000"
            "8007d856"
            "7b2261223a317d");
  EXPECT_EQ(hex(opentrack_datagram({OpenTrackEncoding::kCbor, 7, 0x10203, false, part})),
            "4f54726b0002000700010203"
            "00036dfd"
            "78797a");
}

TEST(OpenTrackIO, ALongSampleIsCutIntoSegments) {
  const auto payload = bytes_of(std::string(3000, 'a'));
  const auto datagrams = opentrack_datagrams(payload, OpenTrackEncoding::kJson, 9);
  ASSERT_EQ(datagrams.size(), 3U);
  std::size_t sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& d = datagrams[i];
    EXPECT_EQ(hex({d.begin() + 6, d.begin() + 8}), "0009");
    const auto number = [&](std::size_t at) { return std::to_integer<std::size_t>(d[at]); };
    EXPECT_EQ(number(10) << 8 | number(11), sum) << "offset";
    EXPECT_EQ(number(12) >> 7, i == 2 ? 1U : 0U) << "last";
    EXPECT_EQ((number(12) & 0x7F) << 8 | number(13), d.size() - 16);
    sum += d.size() - 16;
  }
  EXPECT_EQ(sum, 3000U);
  EXPECT_EQ(opentrack_datagrams({}, OpenTrackEncoding::kJson, 1).size(), 1U);
}

}  // namespace
}  // namespace mixrig::stream
