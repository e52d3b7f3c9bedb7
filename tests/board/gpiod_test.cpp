// SPDX-License-Identifier: Apache-2.0
// The gpiod driver on the kernel's gpio-sim: edges in with the kernel's stamps, a software trigger.
#include "hal/linux/gpiod/gpiod_lines.h"
#include "tests/board/bench.h"
#include "tests/board/sim_chip.h"

namespace mixrig::board {
namespace {

SystemClock g_clock;

TEST(Gpiod, EveryEdgeComesOnceWithAStampBetweenItsCauseAndItsReport) {
  SimChip chip;
  ASSERT_FALSE(chip.name().empty()) << "no gpio-sim";
  auto input = device::open_gpiod_input(chip.name() + "/3");
  ASSERT_TRUE(input) << to_line(input.error());
  constexpr int kEdges = 100;
  std::mutex mutex;
  std::vector<std::pair<device::LineEdge, HostTime>> edges;
  ASSERT_TRUE((*input)->start([&](const device::LineEdge& edge) {
    const std::lock_guard lock(mutex);
    edges.emplace_back(edge, g_clock.now());
  }));
  std::vector<std::pair<HostTime, HostTime>> written;
  for (int i = 0; i < kEdges; ++i) {
    const HostTime before = g_clock.now();
    chip.pull(3, true);
    written.emplace_back(before, g_clock.now());
    g_clock.sleep_until(g_clock.now() + 2ms);
    chip.pull(3, false);
    g_clock.sleep_until(g_clock.now() + 3ms);
  }
  EXPECT_TRUE(wait_until([&] {
    const std::lock_guard lock(mutex);
    return edges.size() == kEdges;
  }));
  (*input)->stop();
  ASSERT_EQ(edges.size(), static_cast<std::size_t>(kEdges));
  Duration stamp_late{}, report_late{};
  for (std::size_t i = 0; i < edges.size(); ++i) {
    EXPECT_EQ(edges[i].first.sequence, i);
    EXPECT_GE(edges[i].first.at, written[i].first);
    EXPECT_LE(edges[i].first.at, edges[i].second);
    stamp_late = std::max(stamp_late, edges[i].first.at - written[i].first);
    report_late = std::max(report_late, edges[i].second - edges[i].first.at);
  }
  EXPECT_LT(stamp_late, 2ms);
  measured("%d edges, stamped at most %.3f ms after the cause, reported at most %.3f ms later",
           kEdges, milliseconds(stamp_late), milliseconds(report_late));
}

TEST(Gpiod, ASoftwareTriggerSwitchesItsLinesAndTellsItsJitter) {
  SimChip chip;
  auto trigger = device::open_gpiod_trigger(chip.name() + "/0,1", g_clock);
  ASSERT_TRUE(trigger) << to_line(trigger.error());
  ASSERT_TRUE((*trigger)->configure(0, {.divider = 4, .phase = 0ms, .width = 15ms}));
  ASSERT_TRUE((*trigger)->configure(1, {.divider = 10, .phase = 0ms, .width = 5ms}));
  ASSERT_TRUE((*trigger)->start());
  std::vector<device::TriggerTick> ticks;
  int rises = 0, last = 0;
  while (ticks.size() < 200) {
    std::array<device::TriggerTick, 16> some;
    const auto count = (*trigger)->read_ticks(some, 20ms);
    ASSERT_TRUE(count);
    ticks.insert(ticks.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(*count));
    const int value = chip.value(0);
    rises += value == 1 && last == 0;
    last = value;
  }
  const auto status = (*trigger)->status();
  ASSERT_TRUE((*trigger)->stop());
  ASSERT_TRUE(status);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    EXPECT_EQ(ticks[i].tick, i);
    EXPECT_EQ(ticks[i].channels, (i % 4 == 0 ? 1U : 0U) | (i % 10 == 0 ? 2U : 0U));
  }
  EXPECT_NEAR(rises, 50, 1);
  EXPECT_EQ(chip.value(0), 0);
  measured("%zu ticks, %d rises of line 0, late by %.3f ms at most", ticks.size(), rises,
           milliseconds(status->late_max));
}

}  // namespace
}  // namespace mixrig::board
