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

/// What is the same in all views.
struct ViewFolderInfo {
  std::string name;
  BoardSpec board;  ///< a checkerboard or a ChArUco board
  Size target_px, tof_px;
  Size fisheye_px;        ///< empty: no fisheye
  bool amplitude = true;  ///< false: the depth camera is left out, the board is not seen in it
  Size tof2_px;           ///< of a second depth camera with amplitude; empty: none
  double depth_unit_m = 0.00025;  ///< of all depth cameras
  capture::DepthKind depth_kind = capture::DepthKind::kZ, depth2_kind = capture::DepthKind::kZ;
  double step_rad = 0;  ///< of the pan-tilt unit; 0: not known
};

/// Whole or not at all, under a temporary name until finish(). Where each view has angles of the
/// pan-tilt unit, and they differ by a degree, it writes them too. Not thread-safe.
class ViewFolder {
 public:
  /// Errors: kUsage for a folder that holds something else, kIo.
  static Result<ViewFolder> create(const std::filesystem::path& folder, ViewFolderInfo info);
  /// Precondition: pictures of the sizes of the info; a missing fisheye's is written black.
  Result<void> add(const StillView& view);
  int views() const { return static_cast<int>(angles_.size()); }
  /// For further files, before finish().
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

/// ptu.csv: degrees, as its header says.
std::string angles_text(const std::vector<device::PanTiltAngles>& angles);

/// Errors: kUsage for a board that views.toml cannot hold, or whose corners change their order with
/// the side from which it is seen: columns and rows of a checkerboard that are both odd or both
/// even.
Result<void> check_view_board(const BoardSpec& board);

}  // namespace mixrig::calibration
