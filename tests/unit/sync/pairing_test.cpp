// SPDX-License-Identifier: Apache-2.0
// Frames are made from known ticks; the result of the pairer is compared with them.
#include "host/capture/sync/pairing.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig::sync {
namespace {

using namespace std::chrono_literals;

HostTime at_s(double s) { return HostTime(Duration(std::llround(s * 1e9))); }

struct Shot {
  std::uint64_t sequence;
  HostTime stamp;
  std::uint64_t tick;  // the truth
};

struct Scenario {
  const char* name;
  double jitter_ms = 0;       // of the frame's stamp, one-sided
  double frame_loss = 0;      // counted by the camera, never delivered
  double tick_loss = 0;       // telemetry of a tick is lost
  double doubled = 0;         // delivered twice
  double swapped = 0;         // delivered after its successor
  double missed_trigger = 0;  // the camera did not expose: its counter does not advance
  double drift_ppm = 0;       // master against host
  int restart_at = -1;        // frame at which the camera's counter restarts
  double duration_s = 60;
  double at_least = 1;  // share of delivered frames that must be usable
  friend void PrintTo(const Scenario& s, std::ostream* out) { *out << s.name; }
};

class PairingScenario : public ::testing::TestWithParam<Scenario> {};

std::vector<Shot> expose(const Scenario& s, int divider, int phase, std::mt19937_64& random) {
  std::uniform_real_distribution<> roll(0, 1);
  std::exponential_distribution<> jitter(s.jitter_ms > 0 ? 1e3 / s.jitter_ms : 1);
  std::vector<Shot> shots;
  std::uint64_t counter = 17;
  const double period_s = 0.01 * (1 + s.drift_ppm * 1e-6);
  int frame = 0;
  for (std::uint64_t tick = static_cast<std::uint64_t>(phase);
       static_cast<double>(tick) * period_s < s.duration_s;
       tick += static_cast<std::uint64_t>(divider), ++frame) {
    if (roll(random) < s.missed_trigger) continue;
    counter = frame == s.restart_at ? 0 : counter + 1;
    if (roll(random) < s.frame_loss) continue;
    const double late_s = s.jitter_ms > 0 ? std::min(jitter(random), 0.015) : 0;
    shots.push_back(
        {counter, at_s(1000 + static_cast<double>(tick) * period_s + 0.004 + late_s), tick});
    if (roll(random) < s.doubled) shots.push_back(shots.back());
  }
  for (std::size_t i = 1; i < shots.size(); ++i)
    if (roll(random) < s.swapped) std::swap(shots[i - 1], shots[i]), ++i;
  return shots;
}

TEST_P(PairingScenario, UsableFramesHaveTheTickThatMadeThem) {
  const Scenario& s = GetParam();
  std::mt19937_64 random(5);
  std::uniform_real_distribution<> roll(0, 1);
  const int divider = 4, phase = 1;
  const auto shots = expose(s, divider, phase, random);
  TickHistory ticks(10ms);
  FramePairer pairer({.divider = divider, .phase = phase, .delay = 4ms});
  std::uint64_t next_tick = 0, usable = 0, wrong = 0;
  const double period_s = 0.01 * (1 + s.drift_ppm * 1e-6);
  for (const Shot& shot : shots) {
    while (at_s(1000 + static_cast<double>(next_tick) * period_s) <= shot.stamp) {
      if (next_tick == 0 || roll(random) >= s.tick_loss)
        ticks.add({next_tick, at_s(1000 + static_cast<double>(next_tick) * period_s)});
      ++next_tick;
    }
    const Pairing pairing = pairer.pair(ticks, shot.sequence, shot.stamp);
    if (!pairing.usable()) continue;
    ++usable;
    if (pairing.tick != shot.tick) ++wrong;
  }
  EXPECT_EQ(wrong, 0U);
  EXPECT_GE(static_cast<double>(usable), s.at_least * static_cast<double>(shots.size()) - 2)
      << "of " << shots.size();
}

INSTANTIATE_TEST_SUITE_P(
    Table, PairingScenario,
    ::testing::Values(Scenario{.name = "clean"}, Scenario{.name = "jitter", .jitter_ms = 5},
                      Scenario{.name = "loss", .frame_loss = 0.1},
                      Scenario{.name = "tick_loss", .tick_loss = 0.3},
                      Scenario{.name = "doubled", .doubled = 0.1, .at_least = 0.89},
                      Scenario{.name = "reordered", .swapped = 0.05},
                      Scenario{.name = "drift_390_ppm", .jitter_ms = 2, .drift_ppm = 390},
                      Scenario{.name = "drift_minus_390_ppm", .drift_ppm = -390},
                      Scenario{.name = "missed_triggers", .missed_trigger = 0.01, .at_least = 0.95},
                      Scenario{.name = "counter_restart", .restart_at = 700, .at_least = 0.995},
                      Scenario{.name = "early_counter_restart", .restart_at = 20, .at_least = 0.98},
                      Scenario{.name = "everything",
                               .jitter_ms = 3,
                               .frame_loss = 0.03,
                               .tick_loss = 0.05,
                               .doubled = 0.02,
                               .swapped = 0.02,
                               .missed_trigger = 0.002,
                               .drift_ppm = 390,
                               .restart_at = 900,
                               .duration_s = 600,
                               .at_least = 0.9},
                      Scenario{.name = "day",
                               .jitter_ms = 3,
                               .frame_loss = 0.001,
                               .drift_ppm = 40,
                               .duration_s = 86400}),
    [](const auto& scenario) { return scenario.param.name; });

TEST(FramePairer, FreeStreamOf30HzIsStampedWithTheNearestTick) {
  TickHistory ticks(10ms);
  FramePairer pairer({.divider = 0});
  std::uint64_t tick = 0;
  for (std::uint64_t frame = 0; frame < 9000; ++frame) {
    const double t = 5 + static_cast<double>(frame) / 30.1;
    while (5 + static_cast<double>(tick) * 0.01 <= t + 0.02) {
      ticks.add({tick, at_s(5 + static_cast<double>(tick) * 0.01)});
      ++tick;
    }
    const Pairing pairing = pairer.pair(ticks, frame, at_s(t));
    ASSERT_EQ(pairing.status, PairStatus::kPaired);
    ASSERT_EQ(pairing.tick, static_cast<std::uint64_t>(std::llround((t - 5) * 100)));
    ASSERT_LE(std::abs(seconds(pairing.residual)), 0.0051);
  }
}

TEST(FramePairer, AFreeCameraTakenForATriggeredOneDoesNotPassForOne) {
  TickHistory ticks(10ms);
  FramePairer pairer({.divider = 4});
  std::uint64_t tick = 0, usable = 0;
  for (std::uint64_t frame = 0; frame < 3000; ++frame) {
    const double t = 5 + static_cast<double>(frame) / 30.1;
    while (5 + static_cast<double>(tick) * 0.01 <= t) {
      ticks.add({tick, at_s(5 + static_cast<double>(tick) * 0.01)});
      ++tick;
    }
    usable += pairer.pair(ticks, frame, at_s(t)).usable() ? 1 : 0;
  }
  EXPECT_GT(pairer.counts().relocks, 200U);
  EXPECT_LT(usable, 2000U);
}

TEST(FramePairer, OneLateFrameIsNamedAndTheNextOnesArePaired) {
  TickHistory ticks(10ms);
  FramePairer pairer({.divider = 4});
  for (std::uint64_t n = 0; n < 200; ++n) ticks.add({n, at_s(1 + 0.01 * static_cast<double>(n))});
  std::vector<PairStatus> status;
  for (std::uint64_t frame = 0; frame < 10; ++frame) {
    const double late_s = frame == 6 ? 0.030 : 0;
    status.push_back(
        pairer.pair(ticks, frame, at_s(1 + 0.04 * static_cast<double>(frame) + late_s)).status);
  }
  EXPECT_EQ(status[1], PairStatus::kLocking);
  EXPECT_EQ(status[2], PairStatus::kPaired);
  EXPECT_EQ(status[6], PairStatus::kLate);
  EXPECT_EQ(status[7], PairStatus::kPaired);
  EXPECT_EQ(pairer.counts().relocks, 0U);
}

TEST(FramePairer, NoTicksNoPairing) {
  TickHistory ticks(10ms);
  FramePairer pairer({.divider = 4});
  EXPECT_EQ(pairer.pair(ticks, 1, at_s(1)).status, PairStatus::kNoTick);
  ticks.add({0, at_s(1)});
  EXPECT_EQ(pairer.pair(ticks, 2, at_s(3)).status, PairStatus::kNoTick);
}

TEST(TickHistory, LostTicksAreInterpolatedAndARestartDropsOlderTicks) {
  TickHistory ticks(10ms);
  for (std::uint64_t n : {10U, 11U, 14U, 15U}) ticks.add({n, at_s(0.01 * static_cast<double>(n))});
  EXPECT_EQ(ticks.lost(), 2U);
  EXPECT_NEAR(*ticks.number_at(at_s(0.1251)), 12.51, 1e-6);
  EXPECT_EQ(*ticks.time_of(13), at_s(0.13));
  EXPECT_FALSE(ticks.number_at(at_s(5)));
  ticks.add({0, at_s(0.5)});
  EXPECT_EQ(ticks.restarts(), 1U);
  EXPECT_NEAR(*ticks.number_at(at_s(0.51)), 1.0, 1e-6);
}

}  // namespace
}  // namespace mixrig::sync
