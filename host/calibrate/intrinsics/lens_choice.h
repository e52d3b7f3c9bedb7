// SPDX-License-Identifier: Apache-2.0
// Selects the number of lens coefficients, and which points are outliers.
#pragma once

#include "host/calibrate/intrinsics/intrinsics.h"

namespace mixrig::calibration {

inline constexpr int kFewestViews = 3;

/// Takes the requested number of lens terms, or the one with the least error on views left out; of
/// those within half a per cent of the least, the fewest terms. A lens that folds inside the image
/// (lens_domain.h) is not taken. Solves `out.bundle` and fills camera, lens_terms, ends_at_points
/// and held_out_px. Errors: kData where no lens fits.
Result<void> choose_lens(Intrinsics& out, Size size_px, const IntrinsicsOptions& options);

}  // namespace mixrig::calibration
