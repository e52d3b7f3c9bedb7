// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/frame_set.h"

#include <vector>

#include <gtest/gtest.h>

#include "hal/device/frame_pool.h"
#include "tests/support/count_allocations.h"

namespace mixrig::sync {
namespace {

class FrameSets : public ::testing::Test {
 protected:
  void add(std::size_t stream, std::uint64_t tick, PairStatus status = PairStatus::kPaired) {
    builder_.add(
        stream,
        {pool_.take().publish({.sequence = tick}, 1), {.status = status, .tick = tick}, {}});
  }
  struct Seen {
    std::uint64_t tick;
    std::array<std::int64_t, 3> ticks;  // -1: empty
    bool complete;
  };
  static std::int64_t tick_of(const TimedFrame& frame) {
    return frame.frame ? static_cast<std::int64_t>(frame.pairing.tick) : -1;
  }
  device::FramePool pool_{32, 1};
  std::array<Seen, 512> seen_{};
  std::size_t count_ = 0;
  FrameSetBuilder builder_{
      std::array{Join{}, Join{2}, Join{5}}, [this](const FrameSet& set) {
        seen_[count_++ % 512] = {
            set.tick,
            {tick_of(set.frames[0]), tick_of(set.frames[1]), tick_of(set.frames[2])},
            set.complete};
      }};
};

TEST_F(FrameSets, WaitsForTheSlowestStream) {
  add(0, 4);
  add(1, 4);
  EXPECT_EQ(count_, 0U);
  add(2, 4);
  ASSERT_EQ(count_, 1U);
  EXPECT_TRUE(seen_[0].complete);
  EXPECT_EQ(seen_[0].ticks, (std::array<std::int64_t, 3>{4, 4, 4}));
}

TEST_F(FrameSets, TakesTheNearestAndNothingTooFar) {
  add(1, 2);
  add(1, 6);
  add(2, 20);
  add(0, 5);
  ASSERT_EQ(count_, 1U);
  EXPECT_EQ(seen_[0].ticks, (std::array<std::int64_t, 3>{5, 6, -1}));
  EXPECT_FALSE(seen_[0].complete);
  EXPECT_EQ(builder_.incomplete(), 1U);
}

/// 25 Hz; every 500th frame of one stream is lost, every 700th of another.
TEST_F(FrameSets, EightHoursAreAccountedForFrameByFrame) {
  constexpr std::uint64_t kFrames = 8 * 3600 * 25;
  std::uint64_t lost = 0, incomplete = 0;
  for (std::uint64_t i = 1; i <= kFrames; ++i) {
    const bool no_lead = i % 500 == 0, no_depth = i % 700 == 0;
    if (!no_lead) add(0, 4 * i);
    if (!no_depth) add(1, 4 * i);
    add(2, 4 * i);
    lost += no_lead, incomplete += no_depth && !no_lead;
  }
  builder_.flush();
  EXPECT_EQ(builder_.sets(), kFrames - lost);
  EXPECT_EQ(count_, kFrames - lost);
  EXPECT_EQ(builder_.incomplete(), incomplete);
  EXPECT_EQ(builder_.refused(), 0U);
  const Seen& last = seen_[(count_ - 1) % 512];
  EXPECT_EQ(last.tick, 4 * (kFrames % 500 == 0 ? kFrames - 1 : kFrames));
}

TEST_F(FrameSets, ASilentCameraDoesNotDelayTheOthers) {
  for (std::uint64_t tick = 4; tick <= 20; tick += 4) {
    add(0, tick);
    add(1, tick);
  }
  EXPECT_EQ(count_, 3U) << "two wait for the camera that stopped sending";
  builder_.flush();
  ASSERT_EQ(count_, 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(seen_[i].tick, 4 * (i + 1));
}

TEST(FrameSetsOfUnequalRates, ASlowerStreamIsNotAwaitedAndNothingLeavesInABurst) {
  device::FramePool pool(32, 1);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> sets;  // tick, tick of the slower stream
  FrameSetBuilder builder(std::array{Join{}, Join{10, false}}, [&](const FrameSet& set) {
    EXPECT_TRUE(set.complete) << set.tick;
    sets.emplace_back(set.tick, set.frames[1].pairing.tick);
  });
  for (std::uint64_t tick = 0; tick < 400; ++tick) {
    const auto frame = [&] {
      return TimedFrame{pool.take().publish({.sequence = tick}, 1),
                        {.status = PairStatus::kPaired, .tick = tick},
                        {}};
    };
    const std::size_t before = sets.size();
    if (tick % 10 == 0) builder.add(1, frame());
    if (tick % 4 == 0) builder.add(0, frame());
    EXPECT_EQ(sets.size() - before, tick % 4 == 0 ? 1U : 0U);
  }
  for (const auto& [tick, slower] : sets) EXPECT_EQ(slower, tick / 10 * 10);
}

TEST_F(FrameSets, UnusableFramesAreRefused) {
  add(0, 4, PairStatus::kLocking);
  add(1, 4, PairStatus::kDuplicate);
  EXPECT_EQ(builder_.refused(), 2U);
  builder_.flush();
  EXPECT_EQ(count_, 0U);
}

TEST_F(FrameSets, NothingIsAllocatedPerFrame) {
  const long before = test::allocations;
  for (std::uint64_t tick = 4; tick < 4000; tick += 4) {
    add(0, tick);
    add(1, tick + 1);
    if (tick % 8 == 0) add(2, tick);
  }
  EXPECT_EQ(test::allocations - before, 0);
  EXPECT_GT(count_, 990U);
}

}  // namespace
}  // namespace mixrig::sync
