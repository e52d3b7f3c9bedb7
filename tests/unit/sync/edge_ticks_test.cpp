// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/edge_ticks.h"

#include <gtest/gtest.h>

namespace mixrig::sync {
namespace {

using namespace std::chrono_literals;

HostTime five_s_and(Duration t) { return HostTime(5s + t); }

TEST(EdgeTicks, PhaseAndDividerDetermineTheTickOfAnEdge) {
  for (const auto& [divider, phase] : {std::pair{1, 0}, {4, 0}, {4, 3}, {10, 7}}) {
    EdgeTicks edges({.divider = divider, .phase = phase, .rest = 2ms}, 10ms, false);
    for (int i = 0; i < 100; ++i) {
      const auto made = edges.add(five_s_and((phase + i * divider) * 10ms + 2ms));
      ASSERT_TRUE(made);
      EXPECT_EQ(made->tick.sequence, static_cast<std::uint64_t>(phase + i * divider));
      EXPECT_EQ(made->tick.at, five_s_and((phase + i * divider) * 10ms));
      EXPECT_FALSE(made->restarted);
    }
  }
}

TEST(EdgeTicks, AFastCrystalAndJitterDoNotMiscount) {
  EdgeTicks edges({.divider = 4}, 10ms, false);
  std::uint64_t wanted = 0;
  for (int i = 0; i < 90'000; ++i) {  // an hour, 400 ppm fast, with 3 ms of jitter and gaps
    if (i % 97 > 90) continue;
    const Duration jitter = std::chrono::microseconds(i * 7919 % 3001);
    const auto made = edges.add(five_s_and(i * 39'984us + jitter));
    ASSERT_TRUE(made) << i;
    ASSERT_EQ(made->tick.sequence, static_cast<std::uint64_t>(4 * i)) << i;
    ++wanted;
  }
  EXPECT_EQ(edges.counts().filled, wanted);
  EXPECT_EQ(edges.counts().lost, 90'000 - wanted);
}

TEST(EdgeTicks, BeforeTheFirstTickOfAMasterNoNumberIsGuessed) {
  EdgeTicks edges({.divider = 4}, 10ms, true);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(edges.add(five_s_and(i * 40ms)));
  EXPECT_EQ(edges.counts().filled, 0U);
}

}  // namespace
}  // namespace mixrig::sync
