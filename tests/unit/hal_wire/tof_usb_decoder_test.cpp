// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/tof_usb_decoder.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"
#include "tests/support/tof_stream.h"

namespace mixrig::device {
namespace {

TofDescription small() {
  TofDescription d;
  d.size = {64, 600};
  d.rate_hz = 25;
  d.amplitude = true;
  d.depth.metres_per_step = 0.00025;
  d.depth.intrinsics = DeviceIntrinsics{210.5, 31.5, 299.5};
  return d;
}

class TofDecoder : public ::testing::Test {
 protected:
  void feed(std::span<const std::uint8_t> bytes) { decoder_.feed(bytes, HostTime{}, sink_); }
  void feed_frame(std::uint32_t frame) {
    for (const auto& packet : test::tof_frame(description_, frame, frame * 40000ULL)) feed(packet);
  }
  bool right(const Frame& frame) const {
    for (int y = 0; y < frame.size.height; ++y)
      for (int x = 0; x < frame.size.width; ++x) {
        const std::size_t at =
            static_cast<std::size_t>(y) * frame.stride_bytes + 2 * static_cast<std::size_t>(x);
        const int step = frame.bytes[at] | frame.bytes[at + 1] << 8;
        if (step != test::tof_step(static_cast<std::uint32_t>(frame.sequence), x, y)) return false;
      }
    return true;
  }
  struct Seen {
    std::uint64_t sequence;
    std::uint32_t flags;
    bool right;
  };
  TofDescription description_ = small();
  FramePool pool_{4, 64 * 600 * 2, 64 * 600 * 2};
  TofUsbDecoder decoder_{description_, pool_};
  std::vector<Seen> seen_;
  FrameSink sink_ = [this](const FramePtr& f) {
    seen_.push_back({f->sequence, f->flags, right(*f)});
  };
};

TEST(Crc32, is_that_of_ieee_802_3) {
  const std::string check = "123456789";
  EXPECT_EQ(tof_crc32({reinterpret_cast<const std::uint8_t*>(check.data()), check.size()}),
            0xCBF43926U);
}

TEST(Crc32, equals_the_bitwise_definition_for_any_length) {
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t i = 0; i < 70; ++i) {
    std::uint32_t wanted = 0xFFFFFFFF;
    for (const std::uint8_t byte : bytes) {
      wanted ^= byte;
      for (int bit = 0; bit < 8; ++bit)
        wanted = (wanted >> 1) ^ ((wanted & 1) != 0 ? 0xEDB88320U : 0U);
    }
    EXPECT_EQ(tof_crc32(bytes), ~wanted) << i << " bytes";
    bytes.push_back(static_cast<std::uint8_t>(i * i * 37 + 11));
  }
}

TEST(TofDescriptionBlock, RoundTripAndDamage) {
  const auto bytes = pack_tof_description(small());
  const auto back = parse_tof_description(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->size, (Size{64, 600}));
  EXPECT_DOUBLE_EQ(back->depth.metres_per_step, 0.00025);
  EXPECT_TRUE(back->amplitude);
  EXPECT_NEAR(back->depth.intrinsics->focal_px, 210.5, 1e-4);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto damaged = bytes;
    damaged[i] ^= 0x10;
    EXPECT_FALSE(parse_tof_description(damaged)) << i;
    EXPECT_FALSE(parse_tof_description(std::span(bytes).first(i)));
  }
}

TEST_F(TofDecoder, CompleteFramesAreDecodedUnchanged) {
  for (std::uint32_t frame = 0; frame < 5; ++frame) feed_frame(frame);
  ASSERT_EQ(seen_.size(), 5U);
  for (std::uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(seen_[i].sequence, i);
    EXPECT_EQ(seen_[i].flags, kFrameOk);
    EXPECT_TRUE(seen_[i].right);
  }
  EXPECT_NEAR(decoder_.depth_health().temperature_c, 41.5, 1e-9);
  EXPECT_NEAR(decoder_.depth_health().mean_amplitude, 1000, 1e-9);
}

TEST_F(TofDecoder, TheStreamMayBeSplitAnywhere) {
  std::vector<std::uint8_t> stream;
  for (std::uint32_t frame = 0; frame < 20; ++frame)
    for (const auto& packet : test::tof_frame(description_, frame, 0))
      stream.insert(stream.end(), packet.begin(), packet.end());
  std::mt19937 random(2);
  for (std::size_t at = 0; at < stream.size();) {
    const std::size_t count = std::min<std::size_t>(1 + random() % 70000, stream.size() - at);
    feed(std::span(stream).subspan(at, count));
    at += count;
  }
  ASSERT_EQ(seen_.size(), 20U);
  for (const Seen& s : seen_) EXPECT_TRUE(s.right && s.flags == kFrameOk);
  EXPECT_EQ(decoder_.health().link_errors, 0U);
}

TEST_F(TofDecoder, ALostPacketCostsOneFrameAndIsCounted) {
  feed_frame(0);
  const auto packets = test::tof_frame(description_, 1, 0);
  for (std::size_t i = 0; i < packets.size(); ++i)
    if (i != 2) feed(packets[i]);
  feed_frame(2);
  ASSERT_EQ(seen_.size(), 3U);
  EXPECT_EQ(seen_[1].flags, kFrameIncomplete);
  EXPECT_EQ(seen_[2].flags, kFrameOk);
  EXPECT_EQ(decoder_.health().incomplete, 1U);
}

TEST_F(TofDecoder, MissingRowsAreUnknownNotOld) {
  std::vector<int> steps;
  FrameSink look = [&](const FramePtr& f) {
    steps.push_back(f->bytes[64 * 2 * 300] | f->bytes[64 * 2 * 300 + 1] << 8);
  };
  for (std::uint32_t frame = 0; frame < 12; ++frame) {
    const auto packets = test::tof_frame(description_, frame, 0);
    for (std::size_t i = 0; i < packets.size(); ++i)
      if (frame % 2 == 0 || i != 2) decoder_.feed(packets[i], HostTime{}, look);  // rows 256..383
  }
  ASSERT_GE(steps.size(), 10U);
  EXPECT_NE(steps[0], 0);
  EXPECT_EQ(steps[1], 0);
}

TEST_F(TofDecoder, ATruncatedPacketDoesNotDamageTheNextFrames) {
  feed_frame(0);
  auto packets = test::tof_frame(description_, 1, 0);
  packets[1].resize(packets[1].size() / 2);
  for (const auto& packet : packets) feed(packet);
  feed_frame(2);
  feed_frame(3);
  ASSERT_EQ(seen_.size(), 4U);
  EXPECT_EQ(seen_[1].flags, kFrameIncomplete);
  EXPECT_TRUE(seen_[2].right && seen_[3].right);
  EXPECT_EQ(decoder_.health().link_errors, 1U);
}

TEST_F(TofDecoder, RowsBeyondThePictureAreRefused) {
  const auto good = test::tof_packet(description_, TofKind::kDistance, 0, 0, 10, 0);
  ASSERT_TRUE(parse_tof_header(good, description_.size));
  TofPacket p = *parse_tof_header(good, description_.size);
  p.first_row = 595;
  EXPECT_FALSE(parse_tof_header(pack_tof_header(p), description_.size));
  p.first_row = 65535;
  EXPECT_FALSE(parse_tof_header(pack_tof_header(p), description_.size));
  p.first_row = 0;
  p.rows = 0;
  p.payload_bytes = 0;
  EXPECT_FALSE(parse_tof_header(pack_tof_header(p), description_.size));
  p.rows = 600;
  p.payload_bytes = 600 * 64 * 2;
  EXPECT_FALSE(parse_tof_header(pack_tof_header(p), description_.size))
      << "more than one packet holds";
}

TEST_F(TofDecoder, ATimeThatDoesNotFitIsRefused) {
  const auto header = [](std::uint64_t time_us) {
    return pack_tof_header(
        {.frame = 1, .rows = 1, .size = {4, 4}, .payload_bytes = 8, .time_us = time_us});
  };
  EXPECT_TRUE(parse_tof_header(header((1ULL << 52) - 1), {4, 4}));
  EXPECT_FALSE(parse_tof_header(header(1ULL << 52), {4, 4}));
  EXPECT_FALSE(parse_tof_header(header(~0ULL), {4, 4}));
}

TEST_F(TofDecoder, AcceptsAnyBytesAndDecodesTheSecondFrameAfterThem) {
  std::mt19937 random(4);
  std::vector<std::uint8_t> noise(300000);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
  feed_frame(0);
  feed(noise);
  feed_frame(1);
  feed_frame(2);
  ASSERT_GE(seen_.size(), 2U);
  EXPECT_TRUE(seen_.back().right);
  EXPECT_EQ(seen_.back().sequence, 2U);
}

TEST_F(TofDecoder, DamagedFramesNeverPassAsComplete) {
  std::mt19937 random(5);
  for (std::uint32_t frame = 0; frame < 300; ++frame)
    for (auto packet : test::tof_frame(description_, frame, 0)) {
      if (random() % 10 == 0)
        packet[random() % packet.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
      if (random() % 50 != 0) feed(packet);
    }
  std::size_t complete = 0;
  for (const Seen& s : seen_) {
    if (s.flags & kFrameIncomplete) continue;
    EXPECT_TRUE(s.right);
    ++complete;
  }
  EXPECT_GT(complete, 60U);
  EXPECT_GT(decoder_.health().incomplete, 50U);
}

TEST_F(TofDecoder, FramesWithoutAFreeBufferAreCountedAsOverrun) {
  std::vector<FramePtr> held;
  FrameSink hold = [&](const FramePtr& f) { held.push_back(f); };
  for (std::uint32_t frame = 0; frame < 8; ++frame)
    for (const auto& packet : test::tof_frame(description_, frame, 0))
      decoder_.feed(packet, HostTime{}, hold);
  EXPECT_EQ(held.size(), 4U);
  EXPECT_EQ(decoder_.health().overrun, 4U);
}

TEST_F(TofDecoder, ARestartCountsNoLostFrames) {
  feed_frame(700);
  decoder_.restart();
  feed_frame(0);
  ASSERT_EQ(seen_.size(), 2U);
  EXPECT_EQ(seen_[1].flags, kFrameRestarted);
  EXPECT_EQ(decoder_.health().lost, 0U);
}

TEST_F(TofDecoder, NothingIsAllocatedPerFrame) {
  std::vector<std::vector<std::vector<std::uint8_t>>> frames;
  for (std::uint32_t frame = 0; frame < 10; ++frame)
    frames.push_back(test::tof_frame(description_, frame, 0));
  int count = 0;
  const FrameSink sink = [&](const FramePtr&) { ++count; };
  const long before = test::allocations;
  for (const auto& packets : frames)
    for (const auto& packet : packets) decoder_.feed(packet, HostTime{}, sink);
  EXPECT_EQ(test::allocations - before, 0);
  EXPECT_EQ(count, 10);
}

}  // namespace
}  // namespace mixrig::device
