// SPDX-License-Identifier: Apache-2.0
// How many coefficients a lens gets, and which points are wrong.
#pragma once

#include "host/calibration/intrinsics.h"

namespace mixrig::calibration {

inline constexpr int kFewestViews = 3;

/// Takes the number of lens terms that is asked for, or that does best on views left out; of those
/// within half a per cent of the best, the fewest. Solves `out.bundle` and fills lens_terms and
/// held_out_px. Errors: kData where no lens fits.
Result<void> choose_lens(Intrinsics& out, Size size_px, const IntrinsicsOptions& options);

}  // namespace mixrig::calibration
