// SPDX-License-Identifier: Apache-2.0
// A lens that zooms and focuses, its encoders, and how it moves in a take.
#pragma once

#include <vector>

#include "studio/studio.h"

namespace mixrig::studio {

/// 0 widest and nearest, 1 longest and farthest.
struct LensSetting {
  double zoom = 0, focus = 0.5;
};

/// At rest (LensSetting{}) it is the target camera of the rig, whose frame has its origin in the
/// entrance pupil then.
struct ZoomLens {
  Optics rest;
  double ratio = 1;  ///< of the longest focal length to that at rest

  Optics optics(const LensSetting& at) const;
  /// Of the entrance pupil along the axis from its place at rest, positive towards the scene.
  double pupil_shift_m(const LensSetting& at) const;
};

/// At rest until the empty frames end; then it zooms in to the end of the take, and its focus is
/// pulled meanwhile. `time_s` may lie outside of the take.
LensSetting lens_at(const StudioInfo& info, double time_s);
/// What ideal encoders say, in counts.
LensCounts counts_of(const LensSetting& at);

}  // namespace mixrig::studio
