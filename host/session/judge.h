// SPDX-License-Identifier: Apache-2.0
// Compares composited frames with the truth of their source.
#pragma once

#include "hal/base/result.h"
#include "host/capture/truth.h"
#include "host/measure/errors.h"
#include "host/render/compositor.h"

namespace mixrig::session {

/// Judges at the truth's size: a composite of another size is resampled first (colour, matte and
/// light bilinear, depth and layer nearest), so that different sizes are comparable.
class Judge {
 public:
  /// Images of a composite that it uses.
  static constexpr render::OutputMask kWanted =
      render::kColor | render::kWarpedDepth | render::kMatte | render::kLight | render::kLayer;
  /// `output` holds the wanted images. Errors: kData for a truth of another size.
  Result<void> add(const capture::Truth& truth, const render::FrameOutput& output);
  measure::Errors errors() const { return measure::errors_of(sums_); }

 private:
  measure::ErrorSums sums_;
};

}  // namespace mixrig::session
