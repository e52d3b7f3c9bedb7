// SPDX-License-Identifier: Apache-2.0
// What the encoders of a lens said when, and what they say at mid-exposure of a frame.
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

/// A gap of the encoders' values that is not interpolated over.
inline constexpr Duration kMostLensGap = std::chrono::milliseconds(100);

/// Linear between the two samples around a time; the first or the last one, where the time is at
/// most kMostLensGap / 2 beyond it. nullopt where the two lie further apart than kMostLensGap.
/// Precondition: times grow. Pure.
std::optional<geometry::LensEncoders> lens_at(std::span<const LensSample> samples, HostTime time);

}  // namespace mixrig::capture
