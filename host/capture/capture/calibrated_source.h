// SPDX-License-Identifier: Apache-2.0
// Replaces the cameras of a take or a rig by those of a calibration file.
#pragma once

#include <filesystem>
#include <memory>

#include "host/capture/capture/capture_source.h"

namespace mixrig::capture {

/// Wraps a source so that its captures have the cameras `target` and `tof` and the pose of `tof`
/// from the calibration file; returns the source unchanged if `file` is empty. Depth is corrected
/// if the file holds its error. The view of the source is kept.
/// If the file has a lens table, each capture gets the lens of its encoder values, clamped to the
/// table's border; without values the last lens is kept. The lens keeps the same bits while it
/// moves by less than 0.05 px.
/// Errors: those of the file; kFormat if it lacks a camera or the pose, or was made from pictures
/// of another size.
Result<std::unique_ptr<CaptureSource>> with_calibration(std::unique_ptr<CaptureSource> source,
                                                        const std::filesystem::path& file);

}  // namespace mixrig::capture
