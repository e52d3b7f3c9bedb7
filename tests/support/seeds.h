// SPDX-License-Identifier: Apache-2.0
// Seeds of the virtual studio, in one place. Nothing may be tuned on a seed above kLastTuned, and
// no default, threshold or bound may be chosen by looking at one. These held-out seeds serve the
// tests of whole runs and the published figures. docs/results/make.py reads this file.
#pragma once

#include <algorithm>
#include <array>

namespace mixrig::test::seeds {

inline constexpr int kLastTuned = 1000;

/// Seeds of the figures in docs/results: held out ones, which `make.py --tag 0.1.0` drew before
/// they were spent, and for comparison some that may be tuned on.
inline constexpr std::array kFigures{787789, 397498};
inline constexpr std::array kTunedFigures{7};
/// Seeds of the figures with an estimated calibration: boards and takes of one rig.
inline constexpr std::array kCalibratedFigures{787789};

/// First and last of ranges above kLastTuned that were rendered or looked at: docs/results/make.py
/// draws none of them.
inline constexpr std::array<std::array<int, 2>, 5> kSpent{
    {{1021, 1063}, {1101, 1109}, {1201, 1206}, {397498, 397498}, {787789, 787789}}};

/// Held-out seeds of tests of whole runs.
inline constexpr int kWalk = 1021, kTalk = 1022, kCoarseWalk = 1023, kMoving = 1031, kSet = 1051;
/// Seed of the test that checks the measures, not the compositor: its margins were looked at.
inline constexpr int kBaselines = 12;
/// Seeds of a take with all imperfections for each depth camera (docs/reference/studio.md). Their
/// bounds were chosen by looking at them: they guard against regressions, and say nothing about
/// other seeds.
inline constexpr int kRealisticSr3000 = 1041, kRealisticKinect2 = 1042, kRealisticHelios2 = 1043;

static_assert(std::ranges::all_of(kFigures, [](int seed) { return seed > kLastTuned; }));
static_assert(std::ranges::all_of(kCalibratedFigures, [](int seed) { return seed > kLastTuned; }));
static_assert(std::ranges::all_of(kTunedFigures, [](int seed) { return seed <= kLastTuned; }));
static_assert(std::min({kWalk, kTalk, kCoarseWalk, kMoving, kSet}) > kLastTuned);
static_assert(kBaselines <= kLastTuned);

}  // namespace mixrig::test::seeds
