// SPDX-License-Identifier: Apache-2.0
// Writes a folder of board views (docs/reference/take.md, views.toml).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hal/base/partial_path.h"
#include "host/calibrate/board/board.h"
#include "host/calibrate/views/mean_capture.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::calibration {

/// Properties that all views share.
struct ViewFolderInfo {
  std::string name;
  BoardSpec board;  ///< a checkerboard or a ChArUco board
  Size target_px, tof_px;
  Size fisheye_px;        ///< empty: no fisheye
  bool amplitude = true;  ///< false: the board is not seen in the depth camera's amplitude, and its
                          ///< pictures are left out
  Size tof2_px;  ///< size of a second depth camera's pictures, if it has amplitude; empty: none
  double depth_unit_m = 0.00025;  ///< one for all depth cameras
  capture::DepthKind depth_kind = capture::DepthKind::kZ, depth2_kind = capture::DepthKind::kZ;
  double step_rad = 0;  ///< resolution of the pan-tilt unit; 0: unknown
};

/// Writes the folder whole or not at all, under a temporary name until finish(). Also writes the
/// angles of the pan-tilt unit where each view has some and they differ by a degree. Not
/// thread-safe.
class ViewFolder {
 public:
  /// Errors: kUsage for a folder that holds something else, kIo.
  static Result<ViewFolder> create(const std::filesystem::path& folder, ViewFolderInfo info);
  /// Precondition: pictures have the sizes of the info. A missing fisheye picture is written black.
  Result<void> add(const StillView& view);
  int views() const { return static_cast<int>(angles_.size()); }
  /// Folder under its temporary name, for further files before finish().
  const std::filesystem::path& staging() const { return partial_.path(); }
  /// Precondition: at least one view.
  Result<void> finish();

 private:
  ViewFolder(PartialPath partial, ViewFolderInfo info)
      : partial_(std::move(partial)), info_(std::move(info)) {}
  bool turned() const;

  PartialPath partial_;
  ViewFolderInfo info_;
  std::vector<std::optional<device::PanTiltAngles>> angles_;
};

/// Text of ptu.csv; degrees, as its header says.
std::string angles_text(const std::vector<device::PanTiltAngles>& angles);

/// Checks that views.toml can hold the board and that its corners have one order from every side.
/// Errors: kUsage, also for a checkerboard whose columns and rows are both odd or both even.
Result<void> check_view_board(const BoardSpec& board);

}  // namespace mixrig::calibration
