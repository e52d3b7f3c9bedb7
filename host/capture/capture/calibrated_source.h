// SPDX-License-Identifier: Apache-2.0
// Replaces the cameras of a take or a rig by those of a calibration file.
#pragma once

#include <filesystem>
#include <memory>

#include "host/capture/capture/capture_source.h"

namespace mixrig::capture {

/// The same captures with the cameras `target` and `tof` and the pose of `tof` of the calibration
/// file; the source unchanged where `file` is empty. Depth is corrected where the file holds its
/// error. The view of the source is kept. Where the file has the table of a lens that zooms, each
/// capture gets its lens: by its encoders, that of the table's border where they lie outside, the
/// last one again where they have no value, and the same bits while it moves by less than 0.05 px.
/// Errors: those of the file; kFormat where it lacks a camera or the pose, or was made from
/// pictures of another size.
Result<std::unique_ptr<CaptureSource>> with_calibration(std::unique_ptr<CaptureSource> source,
                                                        const std::filesystem::path& file);

}  // namespace mixrig::capture
