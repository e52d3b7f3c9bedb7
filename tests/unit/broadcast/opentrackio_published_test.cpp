// SPDX-License-Identifier: Apache-2.0
// OpenTrackIO: the values of the samples that SMPTE publishes, read; and what is sent beside them.
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "extras/broadcast/packets/opentrackio_reader.h"

namespace mixrig::stream {
namespace {

using nlohmann::json;

std::vector<std::byte> bytes_of_text(std::string_view text) {
  std::vector<std::byte> bytes;
  for (const char c : text) bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}

Result<OpenTrackReading> parsed(const json& sample) {
  return parse_opentrack_payload(bytes_of_text(sample.dump()), OpenTrackEncoding::kJson);
}

/// The recommended sample of SMPTE's examples (camdkit 1.0, recommended_dynamic_example.json), and
/// the timing of the complete one. Turned by 180 degrees, then up by 90, then rolled by 45.
constexpr std::string_view kPublished = R"({
  "tracker": {"notes": "Example generated sample.", "recording": false, "slate": "A101_A_4",
              "status": "Optical Good"},
  "timing": {"mode": "external", "sampleRate": {"num": 24000, "denom": 1001},
             "timecode": {"hours": 1, "minutes": 2, "seconds": 3, "frames": 4,
                          "frameRate": {"num": 24000, "denom": 1001}}},
  "lens": {"distortion": [{"radial": [1.0, 2.0, 3.0], "tangential": [1.0, 2.0], "overscan": 3.1}],
           "encoders": {"focus": 0.1, "iris": 0.2, "zoom": 0.3}, "entrancePupilOffset": 0.123,
           "fStop": 4.0, "pinholeFocalLength": 24.305, "focusDistance": 10.0,
           "projectionOffset": {"x": 0.1, "y": 0.2}},
  "protocol": {"name": "OpenTrackIO", "version": [1, 0, 0]},
  "sampleId": "urn:uuid:b5c4292e-8bb7-431d-a719-9f8efa04e916",
  "sourceId": "urn:uuid:a44ae08e-f1e7-4fe9-952e-a043007073c9", "sourceNumber": 1,
  "transforms": [{"translation": {"x": 1.0, "y": 2.0, "z": 3.0},
                  "rotation": {"pan": 180.0, "tilt": 90.0, "roll": 45.0}, "id": "Camera"}]})";

TEST(OpenTrackPublished, ReadsThePublishedSample) {
  auto reading = parse_opentrack_payload(bytes_of_text(kPublished), OpenTrackEncoding::kJson);
  ASSERT_TRUE(reading) << reading.error().context;
  EXPECT_EQ(reading->source, 1);
  EXPECT_EQ(reading->status, "Optical Good");
  EXPECT_FALSE(reading->time_ns) << "it has a timecode alone";
  ASSERT_TRUE(reading->stage_from_camera);
  const geometry::Pose& pose = *reading->stage_from_camera;
  EXPECT_LT((pose.translation_m - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((pose.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  const double half = std::sqrt(0.5);
  const Eigen::Vector3d right(-half, -half, 0);
  EXPECT_LT((pose.rotation * Eigen::Vector3d::UnitX() - right).norm(), 1e-12);

  json complete = json::parse(kPublished);
  complete["timing"] = json::parse(
      R"({"mode": "internal", "sampleTimestamp": {"seconds": 1718806554, "nanoseconds": 500000000},
          "recordedTimestamp": {"seconds": 1718806000, "nanoseconds": 500000000},
          "sequenceNumber": 0, "synchronization": {"locked": true, "source": "ptp", "present": true,
          "ptp": {"profile": "SMPTE ST2059-2:2021", "domain": 1, "leaderAccuracy": 5e-08}}})");
  reading = parsed(complete);
  ASSERT_TRUE(reading);
  EXPECT_EQ(reading->time_ns, 1'718'806'554'500'000'000);
  complete["transforms"][0]["scale"] = {{"x", 1.0}, {"y", 2.0}, {"z", 3.0}};
  EXPECT_FALSE(parsed(complete)) << "its camera is a mesh that is scaled";
}

/// Samples that we send have the names, places and types of the published sample.
TEST(OpenTrackPublished, WhatIsSentIsNamedAsInThePublishedSample) {
  OpenTrackSample sample;
  sample.number = 1, sample.time_ns = 1'000'000'001, sample.status = "ok";
  sample.angles = CameraAngles{0.1, 0.2, 0.3};
  sample.focal_length_mm = 24, sample.sensor = {36, 24, 1280, 720};
  const auto payload = opentrack_payload(sample, OpenTrackEncoding::kJson);
  const auto* const text = reinterpret_cast<const char*>(payload.data());
  const json sent = json::parse(text, text + payload.size()), known = json::parse(kPublished);
  const auto expect_named = [](const json& ours, const json& theirs, const auto& self) -> void {
    for (const auto& [key, value] : theirs.items()) {
      if (!ours.contains(key)) continue;
      EXPECT_EQ(value.is_number(), ours.at(key).is_number()) << key;
      EXPECT_EQ(value.type_name(), std::string(ours.at(key).type_name())) << key;
      if (value.is_object()) self(ours.at(key), value, self);
    }
  };
  expect_named(sent, known, expect_named);
  for (const char* key : {"tracker", "timing", "lens", "protocol", "sampleId", "sourceId",
                          "sourceNumber", "transforms"})
    EXPECT_TRUE(sent.contains(key)) << key;
  expect_named(sent["transforms"][0], known["transforms"][0], expect_named);
  EXPECT_TRUE(sent["transforms"][0].contains("id"));
}

}  // namespace
}  // namespace mixrig::stream
