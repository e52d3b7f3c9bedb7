// SPDX-License-Identifier: Apache-2.0
// A lens that zooms and focuses, its encoders, and how it moves in a take.
#pragma once

#include <vector>

#include "studio/studio.h"

namespace mixrig::studio {

/// Setting of a lens: zoom from 0 (widest) to 1 (longest), focus from 0 (nearest) to 1 (farthest).
struct LensSetting {
  double zoom = 0, focus = 0.5;
};

/// Lens that zooms. At rest (LensSetting{}) it is the target camera of the rig, whose frame then
/// has its origin in the entrance pupil.
struct ZoomLens {
  Optics rest;
  double ratio = 1;  ///< of the longest focal length to that at rest

  Optics optics(const LensSetting& at) const;
  /// Shift of the entrance pupil along the axis from its position at rest, positive towards the
  /// scene.
  double pupil_shift_m(const LensSetting& at) const;
};

/// Setting of the lens at a time: at rest until the empty frames end; then it zooms in to the end
/// of the take while its focus is pulled. `time_s` may lie outside of the take.
LensSetting lens_at(const StudioInfo& info, double time_s);
/// Counts of ideal encoders.
LensCounts counts_of(const LensSetting& at);

}  // namespace mixrig::studio
