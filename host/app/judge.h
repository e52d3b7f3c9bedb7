// SPDX-License-Identifier: Apache-2.0
// Holds composited frames against the truth of their source.
#pragma once

#include "hal/base/result.h"
#include "host/app/source.h"
#include "host/measure/errors.h"
#include "host/render/compositor.h"

namespace mixrig::app {

/// Judges at the truth's size: a composite of another size is brought to it first (colour, matte
/// and light bilinear, depth and layer nearest), so that sizes compare as one sees them.
class Judge {
 public:
  /// `output` with its inspection images, of frame `number`, which was read last from `source`.
  /// Errors: those of reading the truth.
  Result<void> add(FrameSource& source, int number, const render::FrameOutput& output);
  measure::Errors errors() const { return measure::errors_of(sums_); }
  /// Truth of the frame judged last.
  const take::TruthFrame& truth() const { return truth_; }

 private:
  take::TruthFrame truth_;
  measure::ErrorSums sums_;
};

}  // namespace mixrig::app
