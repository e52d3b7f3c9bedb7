// SPDX-License-Identifier: Apache-2.0
// Seeds of the virtual studio, in one place. Nothing may be tuned on a seed above kLastTuned, nor a
// default, threshold or bound chosen by looking at one: such seeds are held out, and are what tests
// of whole runs and published figures use. docs/results/make.py reads this file.
#pragma once

#include <algorithm>
#include <array>

namespace mixrig::test::seeds {

inline constexpr int kLastTuned = 1000;

/// Seeds of the figures in docs/results: held out, and for comparison those that may be tuned on.
inline constexpr std::array kFigures{1101, 1102};
inline constexpr std::array kTunedFigures{7};
/// Seeds of the figures with an estimated calibration: boards and takes of one rig.
inline constexpr std::array kCalibratedFigures{1101};

/// Of tests of whole runs.
inline constexpr int kWalk = 1021, kTalk = 1022, kCoarseWalk = 1023, kMoving = 1031, kSet = 1051;
/// Of the test that judges the measures, not the compositor: its margins were looked at.
inline constexpr int kBaselines = 12;
/// Of a take with all imperfections for each depth camera (docs/reference/studio.md). Their bounds
/// were chosen by looking at them: they hold what is there, and are no figures of other seeds.
inline constexpr int kRealisticSr3000 = 1041, kRealisticKinect2 = 1042, kRealisticHelios2 = 1043;

static_assert(std::ranges::all_of(kFigures, [](int seed) { return seed > kLastTuned; }));
static_assert(std::ranges::all_of(kCalibratedFigures, [](int seed) { return seed > kLastTuned; }));
static_assert(std::ranges::all_of(kTunedFigures, [](int seed) { return seed <= kLastTuned; }));
static_assert(std::min({kWalk, kTalk, kCoarseWalk, kMoving, kSet}) > kLastTuned);
static_assert(kBaselines <= kLastTuned);

}  // namespace mixrig::test::seeds
