// SPDX-License-Identifier: Apache-2.0
// Reads the views of a sweep from a source: frames of equal angles averaged, or frames with poses.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/capture/capture_source.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::session {

inline constexpr int kMostViews = 512;  ///< all are kept in memory

struct SweepViews {
  std::vector<model::ScanView> views;
  std::vector<int> view_of_frame{0};          ///< index of the view by frame number, from 1
  std::vector<device::PanTiltAngles> angles;  ///< of each view; empty where frames have poses
  /// Pose of the base, by the frames' poses; absent where the unit gives the angles.
  std::optional<geometry::Pose> world_from_base;
  int frames = 0;
};

/// Reads views. With `unit`, consecutive frames of equal angles are one view: their depth is
/// averaged as they are read, and their colour is the median (model::PlateMedian). Without a unit
/// each frame is a view at its own pose; the base is then at their mean position with the axes of
/// the world. Errors: those of the source; kData where a frame has no angles, and for more than
/// kMostViews; kUsage without a unit where a frame has no pose.
Result<SweepViews> read_sweep(capture::CaptureSource& source, const calibration_file::PanTilt* unit,
                              Crew& crew);

/// Adds the plates at other exposures of the take in `folder`, if it has some, to the views of
/// their frames; several at one exposure are replaced by their median. Rows of frames that the
/// sweep does not have are ignored. Errors: those of reading; kData for a plate of another size
/// than the frames'.
Result<void> add_brackets(const std::filesystem::path& folder, SweepViews& sweep, Crew& crew);

}  // namespace mixrig::session
