// SPDX-License-Identifier: Apache-2.0
// Compares composited frames with the truth of their source.
#pragma once

#include "hal/base/result.h"
#include "host/capture/capture/truth.h"
#include "host/judge/measure/errors.h"
#include "host/judge/measure/flicker.h"
#include "host/judge/measure/look.h"
#include "host/judge/measure/scraps.h"
#include "host/judge/measure/stairs.h"
#include "host/render/contract/compositor.h"

namespace mixrig::session {

/// Judges at the size of the truth. A composite of another size is resampled first (colour, matte
/// and light bilinear, depth and layer nearest), so that different sizes are comparable.
class Judge {
 public:
  /// Images of a composite that it uses.
  static constexpr render::OutputMask kWanted = render::kColor | render::kMixedDepth |
                                                render::kWarpedDepth | render::kMatte |
                                                render::kLight | render::kLayer;
  /// `room_shown`: the composite shows the real background, as the truth does; without it colour,
  /// light and the look of the objects are not judged.
  explicit Judge(bool room_shown = true) : room_shown_(room_shown) {}
  /// `output` holds the wanted images. Errors: kData for a truth of another size.
  Result<void> add(const capture::Truth& truth, const render::FrameOutput& output);
  /// Adds any other composite in the same way.
  Result<void> add(const capture::Truth& truth, const measure::ResultImages& composite);
  measure::Errors errors() const;
  /// The largest wrong piece of the last frame, in pixels of the truth; 0 pixels: none.
  const measure::Piece& worst_scrap() const { return scraps_.worst(); }

 private:
  Result<void> add_in_size(measure::ResultImages result, const measure::TruthImages& truth);
  Result<void> add_judged(const measure::ResultImages& result, const measure::TruthImages& truth);

  bool room_shown_;
  measure::ErrorSums sums_;
  measure::MatteFlicker flicker_;
  measure::LookSums look_;
  measure::ScrapJudge scraps_;
  measure::Stairs real_stairs_, virtual_stairs_;
  Image<std::uint8_t> own_layer_;
};

}  // namespace mixrig::session
