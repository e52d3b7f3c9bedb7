// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/natnet.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/unit/mocap/natnet_packets.h"

namespace mixrig::stream {
namespace {

constexpr NatNetVersion kOld{3, 0}, kNew{4, 1};

TEST(NatNet, ReadsAFrameOfBothLayouts) {
  for (const NatNetVersion version : {kOld, kNew}) {
    const auto writer = frame_with_body(41, 1.5f, 12.25, version.at_least(4, 1));
    const auto frame = parse_frame(writer.bytes(), version);
    ASSERT_TRUE(frame) << frame.error().context;
    EXPECT_EQ(frame->number, 41);
    EXPECT_EQ(frame->time_s, 12.25);
    ASSERT_EQ(frame->bodies.size(), 1u);
    const NatNetBody& body = frame->bodies[0];
    EXPECT_EQ(body.id, 3);
    EXPECT_TRUE(body.tracked);
    EXPECT_EQ(body.world_from_body.translation_m, Eigen::Vector3d(1.5, 0.5, 0.25));
    EXPECT_LT((body.world_from_body.rotation * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitX())
                  .norm(),
              1e-9);
    ASSERT_EQ(frame->markers.size(), 1u);
    EXPECT_EQ(frame->markers[0].body_id, 3);
    EXPECT_EQ(frame->markers[0].marker_id, 2);
    EXPECT_TRUE(frame->markers[0].occluded);
    EXPECT_NEAR(frame->markers[0].residual_m, 0.0002, 1e-9);
  }
}

TEST(NatNet, RefusesEveryCutAndNeverReadsPastIt) {
  for (const NatNetVersion version : {kOld, kNew}) {
    const auto whole = frame_with_body(1, 0, 1, version.at_least(4, 1)).bytes();
    // The bytes after the time stamp are not needed.
    for (std::size_t size = 0; size + 40 < whole.size(); ++size) {
      const std::vector<std::byte> cut(whole.begin(), whole.begin() + size);
      const auto frame = parse_frame(cut, version);
      ASSERT_FALSE(frame) << size;
      EXPECT_NE(frame.error().context.find("section of"), std::string::npos);
    }
  }
}

TEST(NatNet, BearsAnyDamage) {
  std::mt19937 random(1);
  for (const NatNetVersion version : {kOld, kNew}) {
    const auto whole = frame_with_body(1, 0, 1, version.at_least(4, 1)).bytes();
    for (int trial = 0; trial < 20000; ++trial) {
      auto bytes = whole;
      for (int hit = 0; hit < 4; ++hit)
        bytes[random() % bytes.size()] = static_cast<std::byte>(random());
      const auto frame = parse_frame(bytes, version);
      if (!frame) continue;
      EXPECT_LT(frame->bodies.size(), bytes.size());
      for (const NatNetBody& body : frame->bodies)
        if (body.tracked) {
          EXPECT_NEAR(body.world_from_body.rotation.norm(), 1, 1e-9);
        }
    }
  }
}

TEST(NatNet, RefusesCountsThatThePacketCannotHold) {
  PacketWriter w;
  w.put(std::int32_t{1}).put(std::int32_t{0x7fffffff});
  EXPECT_FALSE(parse_frame(w.bytes(), kOld));
  PacketWriter negative;
  negative.put(std::int32_t{1}).put(std::int32_t{-1});
  EXPECT_FALSE(parse_frame(negative.bytes(), kOld));
}

TEST(NatNet, ReadsACaptureWithTheVersionThatItStates) {
  PacketWriter info;
  for (int i = 0; i < 260; ++i) info.put('\0');
  info.put(std::uint8_t{4}).put(std::uint8_t{1}).put(std::uint8_t{0}).put(std::uint8_t{0});
  auto bytes = info.packet(1);
  for (int i = 0; i < 3; ++i)
    for (std::byte b : frame_with_body(i, 0, i, true).packet(7)) bytes.push_back(b);
  for (std::byte b : PacketWriter().put(1.0).packet(13)) bytes.push_back(b);
  const auto frames = parse_capture(bytes, kOld);
  ASSERT_TRUE(frames) << frames.error().context;
  EXPECT_EQ(frames->size(), 3u);
  bytes.pop_back();
  const auto cut = parse_capture(bytes, kOld);
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().context.find("packet 5"), std::string::npos) << cut.error().context;
}

TEST(NatNet, RefusesAnOldServer) {
  PacketWriter info;
  for (int i = 0; i < 260; ++i) info.put('\0');
  info.put(std::uint8_t{2}).put(std::uint8_t{10});
  const auto version = parse_server_info(info.bytes());
  ASSERT_FALSE(version);
  EXPECT_EQ(version.error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace mixrig::stream
