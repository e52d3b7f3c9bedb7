// SPDX-License-Identifier: Apache-2.0
// Plates of a recorded sweep at other exposures. Private to this module.
#pragma once

#include <filesystem>
#include <vector>

#include "host/capture/capture/bracket.h"
#include "host/capture/take/bracket_files.h"
#include "studio/studio.h"

namespace mixrig::studio_io {

capture::ExposureLimits exposure_limits();

/// Renders the last frame of a view again, at each exposure that is worth taking, and adds picture
/// and row. `plate` is that frame's. Errors: kIo.
Result<void> add_bracket(studio::Studio& studio, int frame, const Image<Rgb8>& plate,
                         const std::filesystem::path& folder, std::vector<take::BracketRow>& rows);

/// Writes bracket.csv, and truth/light.exr: the true light in all directions from the base of the
/// unit. Errors: kIo.
Result<void> write_bracket(studio::Studio& studio, const std::vector<take::BracketRow>& rows,
                           const std::filesystem::path& folder);

}  // namespace mixrig::studio_io
