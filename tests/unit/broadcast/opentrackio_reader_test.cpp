// SPDX-License-Identifier: Apache-2.0
// OpenTrackIO read: the reference sender's datagrams, samples of others, damaged and hostile ones.
#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "extras/broadcast/packets/opentrackio_receiver.h"
#include "host/output/datagrams/datagram_sender.h"
#include "tests/support/refusal.h"

namespace mixrig::stream {
namespace {

using nlohmann::json;
using Bytes = std::vector<std::byte>;

Bytes raw_bytes(std::string_view text) {
  Bytes bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

Bytes payload_of(const json& sample, OpenTrackEncoding encoding) {
  if (encoding == OpenTrackEncoding::kJson) return raw_bytes(sample.dump());
  const std::vector<std::uint8_t> cbor = json::to_cbor(sample);
  return raw_bytes({reinterpret_cast<const char*>(cbor.data()), cbor.size()});
}

json transform(double x_m, double y_m, double z_m, double pan_deg, double tilt_deg,
               double roll_deg) {
  return {{"translation", {{"x", x_m}, {"y", y_m}, {"z", z_m}}},
          {"rotation", {{"pan", pan_deg}, {"tilt", tilt_deg}, {"roll", roll_deg}}}};
}

json read_sample() {
  return {{"protocol", {{"name", "OpenTrackIO"}, {"version", {1, 0, 1}}}},
          {"sourceNumber", 7},
          {"tracker", {{"status", "Optical Good"}}},
          {"timing", {{"sampleTimestamp", {{"seconds", 1718806554}, {"nanoseconds", 500000000}}}}},
          {"transforms", json::array({transform(1, 2, 3, 90, 0, 0)})}};
}

Result<OpenTrackReading> read(const json& sample) {
  return parse_opentrack_payload(payload_of(sample, OpenTrackEncoding::kJson),
                                 OpenTrackEncoding::kJson);
}

TEST(OpenTrackReader, ReadsPoseTimeAndSourceFromBothEncodings) {
  for (const auto encoding : {OpenTrackEncoding::kJson, OpenTrackEncoding::kCbor}) {
    const auto reading = parse_opentrack_payload(payload_of(read_sample(), encoding), encoding);
    ASSERT_TRUE(reading) << reading.error().context;
    EXPECT_EQ(reading->source, 7);
    EXPECT_EQ(reading->status, "Optical Good");
    EXPECT_EQ(reading->time_ns, 1'718'806'554'500'000'000);
    ASSERT_TRUE(reading->stage_from_camera);
    const geometry::Pose& pose = *reading->stage_from_camera;
    EXPECT_LT((pose.translation_m - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
    // A camera turned by 90 degrees to the left looks along -x; its right is +y, its down -z.
    EXPECT_LT((pose.rotation * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitX()).norm(), 1e-12);
    EXPECT_LT((pose.rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
    EXPECT_LT((pose.rotation * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  }
}

TEST(OpenTrackReader, TransformsFollowOneAnother) {
  json chain = read_sample();
  // A dolly at (10, 0, 0) turned to the left by 90 degrees carries a camera 2 m ahead, 1 m up.
  chain["transforms"] = json::array({transform(10, 0, 0, 90, 0, 0), transform(0, 2, 1, -90, 0, 0)});
  const auto reading = read(chain);
  ASSERT_TRUE(reading && reading->stage_from_camera);
  const geometry::Pose& pose = *reading->stage_from_camera;
  EXPECT_LT((pose.translation_m - Eigen::Vector3d(8, 0, 1)).norm(), 1e-12);
  EXPECT_LT((pose.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST(OpenTrackReader, WhatIsMissingIsNotKnown) {
  json bare = read_sample();
  for (const char* key : {"transforms", "timing", "tracker", "sourceNumber"}) bare.erase(key);
  const auto reading = read(bare);
  ASSERT_TRUE(reading) << reading.error().context;
  EXPECT_FALSE(reading->stage_from_camera);
  EXPECT_FALSE(reading->time_ns);
  EXPECT_EQ(reading->source, 0);
}

TEST(OpenTrackReader, RefusesWhatIsWrongInOneLine) {
  const auto expect = [](const char* path, const json& value, const char* says) {
    json wrong = read_sample();
    wrong[json::json_pointer(path)] = value;
    EXPECT_TRUE(test::refused(read(wrong), {says})) << path;
  };
  expect("/protocol/name", "FreeTrack", "another protocol");
  expect("/protocol/version", json::array({2, 0, 0}), "another version");
  expect("/protocol", 3, "another protocol");
  expect("/transforms", json::array(), "no list");
  expect("/transforms/0/translation/x", "1", "transforms.translation.x is no number");
  expect("/transforms/0/translation/x", 1e9, "out of bounds");
  expect("/transforms/0/rotation", nullptr, "transforms.rotation.pan is no number");
  expect("/transforms/0/scale", json{{"x", 2}, {"y", 1}, {"z", 1}}, "scales");
  expect("/timing/sampleTimestamp/seconds", -1, "no time");
  expect("/timing/sampleTimestamp/seconds", 1e30, "no time");
  expect("/timing/sampleTimestamp/nanoseconds", 1'000'000'000, "no time");
  for (const char* text : {"", "{", "[1]", "{\"a\":1}x", "\xff"})
    for (const auto encoding : {OpenTrackEncoding::kJson, OpenTrackEncoding::kCbor})
      EXPECT_FALSE(parse_opentrack_payload(raw_bytes(text), encoding)) << text;
}

TEST(OpenTrackReader, DeepNestingIsRefusedBeforeTheStackEnds) {
  const Bytes cbor(60000, std::byte{0x81});  // an array in an array in ...
  EXPECT_FALSE(parse_opentrack_payload(cbor, OpenTrackEncoding::kCbor));
  EXPECT_FALSE(parse_opentrack_payload(Bytes(60000, std::byte{0xC1}), OpenTrackEncoding::kCbor));
  EXPECT_FALSE(
      parse_opentrack_payload(raw_bytes(std::string(60000, '[')), OpenTrackEncoding::kJson));
}

/// Bytes of camdkit's sender (test/python/parser); opentrackio_test.cpp has the same.
TEST(OpenTrackReader, ReadsDatagramsOfTheReferenceSender) {
  Bytes bytes = raw_bytes({"OTrk\x00\x01\x12\x34\x00\x00\x00\x00\x80\x07\xd8\x56{\"a\":1}", 23});
  const auto segment = parse_opentrack_datagram(bytes);
  ASSERT_TRUE(segment) << segment.error().context;
  EXPECT_EQ(segment->encoding, OpenTrackEncoding::kJson);
  EXPECT_EQ(segment->sequence, 0x1234);
  EXPECT_EQ(segment->offset, 0U);
  EXPECT_TRUE(segment->last);
  EXPECT_EQ(Bytes(segment->payload.begin(), segment->payload.end()), raw_bytes("{\"a\":1}"));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    Bytes damaged = bytes;
    damaged[i] ^= std::byte{0x10};
    EXPECT_FALSE(parse_opentrack_datagram(damaged)) << i;
    EXPECT_FALSE(parse_opentrack_datagram(std::span(bytes).first(i))) << i;
  }
}

constexpr Sender kTracker{0x7F000001, 5000};

std::vector<OpenTrackSegment> segments_of(std::span<const std::byte> payload,
                                          std::uint16_t sequence, std::size_t size) {
  std::vector<OpenTrackSegment> segments;
  for (std::size_t at = 0; at < payload.size(); at += size) {
    const std::size_t part = std::min(size, payload.size() - at);
    segments.push_back({OpenTrackEncoding::kJson, sequence, static_cast<std::uint32_t>(at),
                        at + part == payload.size(), payload.subspan(at, part)});
  }
  return segments;
}

TEST(OpenTrackAssembler, PutsSegmentsTogetherInAnyOrderAndOnce) {
  const Bytes payload = raw_bytes(read_sample().dump());
  std::mt19937 random(3);
  OpenTrackAssembler assembler;
  for (std::uint16_t sequence = 65500; sequence != 100; ++sequence) {
    auto segments = segments_of(payload, sequence, 40);
    segments.push_back(segments[random() % segments.size()]);  // one comes twice
    std::shuffle(segments.begin(), segments.end(), random);
    int whole = 0;
    for (const auto& segment : segments)
      if (const auto done = assembler.add(segment, kTracker)) {
        ++whole;
        EXPECT_TRUE(
            std::equal(done->bytes.begin(), done->bytes.end(), payload.begin(), payload.end()));
      }
    ASSERT_EQ(whole, 1) << sequence;
  }
}

TEST(OpenTrackAssembler, KeepsTheSamplesOfSeveralSendersApart) {
  json other = read_sample();
  other["sourceNumber"] = 8;
  const Bytes payloads[] = {raw_bytes(read_sample().dump()), raw_bytes(other.dump())};
  const Sender senders[] = {kTracker, {kTracker.address, 9}, {7, kTracker.port}};
  for (const Sender& second : senders) {
    OpenTrackAssembler assembler;
    const bool apart = second.address != kTracker.address || second.port != kTracker.port;
    for (std::uint16_t sequence = 0; sequence < 20; ++sequence) {
      const auto a = segments_of(payloads[0], sequence, 40),
                 b = segments_of(payloads[1], sequence, 40);
      std::vector<Bytes> whole;
      const auto add = [&](const OpenTrackSegment& segment, const Sender& from) {
        const auto done = assembler.add(segment, from);
        if (done) whole.emplace_back(done->bytes.begin(), done->bytes.end());
      };
      if (apart)  // mixed
        for (std::size_t i = 0; i < a.size(); ++i) add(a[i], kTracker), add(b[i], second);
      else  // one sender of both: a sample after the other
        for (const auto* segments : {&a, &b})
          for (const auto& segment : *segments) add(segment, kTracker);
      ASSERT_EQ(whole.size(), 2U) << second.port;
      EXPECT_EQ(whole[0], payloads[0]);
      EXPECT_EQ(whole[1], payloads[1]);
    }
  }
}

TEST(OpenTrackAssembler, RefusesSamplesThatContradictThemselves) {
  const Bytes bytes(100);
  const std::span<const std::byte> part(bytes);
  struct Row {
    OpenTrackSegment first, second;
  };
  const auto text = OpenTrackEncoding::kJson;
  const Row rows[] = {
      {{text, 1, 0, false, part}, {text, 1, 50, true, part}},     // overlap
      {{text, 1, 0, true, part}, {text, 1, 100, true, part}},     // two ends
      {{text, 1, 0, true, part}, {text, 1, 200, false, part}},    // behind the end
      {{text, 1, 0, false, part}, {text, 1, 65500, true, part}},  // longer than 64 KiB
      {{text, 1, 0, false, part}, {text, 1, 0xFFFFFFF0, true, part}},
      {{text, 1, 0, false, part}, {OpenTrackEncoding::kCbor, 1, 100, true, part}},
  };
  for (const Row& row : rows) {
    OpenTrackAssembler assembler;
    (void)assembler.add(row.first, kTracker);
    EXPECT_FALSE(assembler.add(row.second, kTracker)) << row.second.offset;
  }
}

TEST(OpenTrackReceiver, ReadsOneSourceAndCountsTheRest) {
  auto receiver = OpenTrackReceiver::open({"127.0.0.1", 0, {}});
  ASSERT_TRUE(receiver) << receiver.error().context;
  auto sender = DatagramSender::open("127.0.0.1:" + std::to_string(receiver->port()));
  ASSERT_TRUE(sender);
  const auto send = [&](const json& sample, std::uint16_t sequence) {
    const Bytes payload = raw_bytes(sample.dump());
    for (const auto& datagram : opentrack_datagrams(payload, OpenTrackEncoding::kJson, sequence))
      sender->send({reinterpret_cast<const char*>(datagram.data()), datagram.size()});
  };
  json other = read_sample(), wrong = read_sample();
  other["sourceNumber"] = 8;
  wrong["transforms"] = 1;
  send(read_sample(), 1);
  send(other, 2);
  send(wrong, 3);
  sender->send("no packet");
  send(read_sample(), 5);
  int samples = 0;
  for (int i = 0; i < 5; ++i) {
    const auto reading = receiver->next(std::chrono::seconds(20));
    ASSERT_TRUE(reading) << reading.error().context;
    samples += reading->has_value();
  }
  EXPECT_EQ(samples, 2);
  const StreamCounts counts = receiver->counts();
  EXPECT_EQ(counts.packets, 2);
  EXPECT_EQ(counts.foreign, 1);
  EXPECT_EQ(counts.malformed, 2);
  EXPECT_EQ(counts.lost, 3) << "2, 3 and 4 are not samples of the source";
}

/// Two trackers that were switched on together, or `apart` numbers from each other.
TEST(OpenTrackReceiver, HasEverySampleOfItsSourceWhateverAnotherSends) {
  for (const int apart : {0, 3, -3, 200, 5000}) {
    for (const bool one_socket : {true, false}) {
      auto receiver = OpenTrackReceiver::open({"127.0.0.1", 0, 7});
      ASSERT_TRUE(receiver) << receiver.error().context;
      const std::string to = "127.0.0.1:" + std::to_string(receiver->port());
      auto first = DatagramSender::open(to), second = DatagramSender::open(to);
      ASSERT_TRUE(first && second);
      json other = read_sample();
      other["sourceNumber"] = 8;
      int samples = 0;
      for (int i = 0; i < 40; ++i) {
        for (const bool mine : {false, true}) {
          const auto sequence = static_cast<std::uint16_t>(mine ? i : i + apart);
          const Bytes payload = raw_bytes((mine ? read_sample() : other).dump());
          const auto datagram = opentrack_datagrams(payload, OpenTrackEncoding::kJson, sequence)[0];
          (mine || one_socket ? first : second)
              ->send({reinterpret_cast<const char*>(datagram.data()), datagram.size()});
          const auto reading = receiver->next(std::chrono::seconds(20));
          ASSERT_TRUE(reading);
          EXPECT_TRUE(!*reading || (*reading)->source == 7);
          samples += reading->has_value();
        }
      }
      EXPECT_EQ(samples, 40) << apart;
      EXPECT_EQ(receiver->counts().foreign, 40);
      EXPECT_EQ(receiver->counts().late + receiver->counts().lost, 0) << apart;
    }
  }
}

TEST(OpenTrackReceiver, CountsWhatIsLostLateAndOfAnotherVersion) {
  testing::internal::CaptureStderr();
  auto receiver = OpenTrackReceiver::open({"127.0.0.1", 0, {}});
  ASSERT_TRUE(receiver);
  auto sender = DatagramSender::open("127.0.0.1:" + std::to_string(receiver->port()));
  ASSERT_TRUE(sender);
  json newer = read_sample();
  newer["protocol"]["version"] = {2, 0, 0};
  const auto comes = [&](std::uint16_t sequence, const json& sample) {
    const auto datagram =
        opentrack_datagrams(raw_bytes(sample.dump()), OpenTrackEncoding::kJson, sequence)[0];
    sender->send({reinterpret_cast<const char*>(datagram.data()), datagram.size()});
    const auto reading = receiver->next(std::chrono::seconds(20));
    return reading && *reading;
  };
  EXPECT_TRUE(comes(65535, read_sample()));
  EXPECT_TRUE(comes(3, read_sample())) << "0, 1 and 2 are lost";
  EXPECT_FALSE(comes(3, read_sample())) << "once more";
  EXPECT_FALSE(comes(1, read_sample())) << "late";
  EXPECT_TRUE(comes(60000, read_sample())) << "far back: the sender restarted";
  EXPECT_FALSE(comes(60001, newer));
  EXPECT_FALSE(comes(60002, newer));
  EXPECT_EQ(receiver->counts().lost, 3);
  EXPECT_EQ(receiver->counts().late, 2);
  EXPECT_EQ(receiver->counts().other_version, 2);
  EXPECT_EQ(receiver->counts().malformed, 0);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("a sample of another version, 1 is read"), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
}

TEST(OpenTrackReceiver, ReadsItsAddress) {
  const auto group = parse_opentrack_address("opentrackio:239.135.1.7:55555,7");
  ASSERT_TRUE(group) << group.error().context;
  EXPECT_EQ(group->host, "239.135.1.7");
  EXPECT_EQ(group->number, 7);
  EXPECT_EQ(parse_opentrack_address("opentrackio:5000")->host, "127.0.0.1");
  for (const char* wrong : {"opentrackio:", "opentrackio:0", "opentrackio:5000,0",
                            "opentrackio:5000,201", "opentrackio:tracker:5000", "freed:5000"})
    EXPECT_FALSE(parse_opentrack_address(wrong)) << wrong;
}

}  // namespace
}  // namespace mixrig::stream
