// SPDX-License-Identifier: Apache-2.0
// calibration.yaml in place of what a take or a rig says of its cameras.
#pragma once

#include <filesystem>
#include <memory>

#include "host/app/source.h"

namespace mixrig::app {

/// The same frames with the cameras `target` and `tof` and the pose of `tof` of a calibration.yaml:
/// `calibration`, or where that is empty the one that the source names, or else the source as it
/// is. Depth is corrected where the file holds its error. A view that the source gives stays.
/// Errors: those of the file; kFormat where it lacks a camera or the pose, or was made of pictures
/// of another size.
Result<std::unique_ptr<FrameSource>> with_calibration(std::unique_ptr<FrameSource> source,
                                                      const std::filesystem::path& calibration);

}  // namespace mixrig::app
