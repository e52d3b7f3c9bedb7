// SPDX-License-Identifier: Apache-2.0
// Packets of a real server: *.bin of mocap-natnet (NatNet 3.0).
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "host/pose/mocap/natnet.h"

namespace mixrig::stream {
namespace {

namespace fs = std::filesystem;

class NatNetData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("MIXRIG_DATA");
    if (root == nullptr || !fs::exists(fs::path(root) / "mocap-natnet"))
      GTEST_SKIP()
          << "needs the recording mocap-natnet: set MIXRIG_DATA to the folder that holds it";
    folder_ = fs::path(root) / "mocap-natnet";
  }
  std::vector<std::byte> read(const char* name) {
    std::ifstream file(folder_ / name, std::ios::binary);
    std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
  }
  fs::path folder_;
};

TEST_F(NatNetData, ReadsTheServersVersion) {
  const auto bytes = read("serverinfo_packet_v3.bin");
  const auto packet = next_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->size, bytes.size());
  const auto version = parse_server_info(packet->payload);
  ASSERT_TRUE(version) << version.error().context;
  EXPECT_EQ(version->major, 3);
  EXPECT_EQ(version->minor, 0);
}

TEST_F(NatNetData, ReadsAFrameWithAnOccludedMarker) {
  const auto frames = parse_capture(read("mocapframe_packet_occluded_v3.bin"), {3, 0});
  ASSERT_TRUE(frames) << frames.error().context;
  ASSERT_EQ(frames->size(), 1u);
  const NatNetFrame& frame = (*frames)[0];
  EXPECT_EQ(frame.number, 269007);
  EXPECT_NEAR(frame.time_s, 8966.9, 1e-6);
  ASSERT_EQ(frame.bodies.size(), 1u);
  EXPECT_EQ(frame.bodies[0].id, 7);
  EXPECT_TRUE(frame.bodies[0].tracked);
  EXPECT_NEAR(frame.bodies[0].world_from_body.translation_m.y(), 0.2829448, 1e-7);
  ASSERT_EQ(frame.markers.size(), 4u);
  EXPECT_TRUE(frame.markers[0].occluded);
  EXPECT_FALSE(frame.markers[1].occluded);
  EXPECT_EQ(frame.markers[0].body_id, 7);
  EXPECT_EQ(frame.markers[3].marker_id, 5);
}

TEST_F(NatNetData, SkipsPacketsOfOtherKinds) {
  for (const char* name : {"modeldef_packet_v3.bin", "echoresponse_packet_v3.bin",
                           "connect_packet_v3.bin", "discovery_packet_v3.bin"}) {
    const auto frames = parse_capture(read(name), {3, 0});
    ASSERT_TRUE(frames) << name << ": " << frames.error().context;
    EXPECT_TRUE(frames->empty());
  }
  const auto frames = parse_capture(read("mocapframe_packet_v3.bin"), {3, 0});
  ASSERT_TRUE(frames);
  EXPECT_EQ(frames->size(), 1u);
}

}  // namespace
}  // namespace mixrig::stream
