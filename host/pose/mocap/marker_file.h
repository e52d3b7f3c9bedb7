// SPDX-License-Identifier: Apache-2.0
// Reads recordings of a motion-capture system as CSV with named columns.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.h"
#include "host/pose/mocap/natnet.h"

namespace mixrig::mocap {

/// Reads CSV whose first line names its columns, one marker or one body per line, frames in order
/// of time. Markers: frame, t_s, x_m, y_m, z_m, and where known model_id, marker_id, occluded,
/// residual_m. Bodies: frame, t_s, id, x_m, y_m, z_m, qx, qy, qz, qw, and where known valid,
/// mean_error_m. Other columns are ignored. Lines with the same frame number make a frame.
/// Errors: kNotFound; kFormat, name:line, for a missing column or a value that is not a number.
Result<std::vector<stream::NatNetFrame>> read_mocap_csv(const std::filesystem::path& path);
/// Parses the text of such a file. Pure: the entry point of the fuzzer.
Result<std::vector<stream::NatNetFrame>> parse_mocap_csv(std::string_view text,
                                                         const std::string& name);

}  // namespace mixrig::mocap
