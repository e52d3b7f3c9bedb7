// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D folders (Sturm et al. 2012): rgb.txt, depth.txt, groundtruth.txt. Private to this
// module.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "host/capture/take/manifest.h"
#include "host/capture/take/trajectory.h"

namespace mixrig::take {

/// Numbers between blanks and commas; '#' starts a comment. nullopt for anything else. Pure.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

bool is_tum_folder(const std::filesystem::path& folder);

/// Returns the manifest of a TUM folder without take.toml: depth registered to colour, 1/5000 m,
/// ground truth where the folder has it. The camera is that of calibration.txt (fx fy cx cy, in one
/// line or as a 3x3 matrix; behind four numbers k1 k2 p1 p2 [k3]) with the size of the first
/// picture, else that published for the data set by whose name the folder begins, else the nominal
/// one of the Kinect (525, 319.5, 239.5 at 640x480). What is assumed is
/// told in a warning. Errors: kFormat for a calibration.txt that is neither, kNotFound.
Result<Manifest> tum_manifest(const std::filesystem::path& folder);

/// Pairs colour and depth stamps and returns their indices: each at most once, closest pairs first,
/// at most `max_difference_s` apart; sorted by colour.
std::vector<std::pair<int, int>> associate(const std::vector<StampedFile>& color,
                                           const std::vector<StampedFile>& depth,
                                           double max_difference_s);

}  // namespace mixrig::take
