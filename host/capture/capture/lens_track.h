// SPDX-License-Identifier: Apache-2.0
// Encoder values of a lens over time, and their interpolation to mid-exposure of a frame.
#pragma once

#include <chrono>
#include <optional>
#include <span>

#include "hal/base/clock.h"
#include "host/math/geometry/lens_table.h"

namespace mixrig::capture {

struct LensSample {
  HostTime time{};  ///< on the clock of the frames' mid-exposures
  geometry::LensEncoders at;
};

/// Longest gap between encoder values that is interpolated over.
inline constexpr Duration kMostLensGap = std::chrono::milliseconds(100);

/// Interpolates linearly between the two samples around `time`; nullopt if these lie further apart
/// than kMostLensGap. Before the first and after the last sample it returns that sample, for at
/// most kMostLensGap / 2; nullopt beyond. Precondition: times grow. Pure.
std::optional<geometry::LensEncoders> lens_at(std::span<const LensSample> samples, HostTime time);

}  // namespace mixrig::capture
