// SPDX-License-Identifier: Apache-2.0
// Chooses board views from the captures of a rig: still, and of use to its calibration.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/calibrate/views/coverage.h"
#include "host/calibrate/views/still_board.h"
#include "host/calibrate/views/view_folder.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::calibration {

struct CollectSettings {
  BoardSpec board;
  int views = 15;  ///< wanted number of views that target and depth camera share
  int frames = 8;  ///< 3..64 frames in a row must show a board at rest; their mean is the view
  Duration still_time = std::chrono::milliseconds(250);  ///< least time from the first to the last
  double rest_px = 0.25;     ///< motion of the board in a picture that counts as rest
  double rest_m = 0.002;     ///< motion of the board in depth that counts as rest
  bool every_place = false;  ///< keeps each new place: the cameras turn before a fixed board
  double step_rad = 0;       ///< resolution of the pan-tilt unit, for views.toml; 0: unknown
};

/// Result for a capture.
enum class CollectState {
  kNoBoard,   ///< neither the target camera nor the fisheye sees it
  kSettling,  ///< too few frames yet
  kMoving,
  kBlurred,  ///< far less sharp than earlier views, by motion or focus
  kKnown,    ///< still, but it adds nothing
  kKept
};

struct CollectCounts {
  int frames = 0, in_target = 0, in_fisheye = 0;
  int still = 0;                        ///< number of windows that show the board at rest
  int without_tof = 0, moving_tof = 0;  ///< of these windows: the depth camera does not see the
                                        ///< board, or sees it move
  int blurred = 0;
  double least_motion_px = 0;  ///< of the full windows that were not at rest; 0: there was none
};

/// Chooses views for a folder. Writes only under the folder's temporary name until finish(). One
/// thread.
class ViewCollector {
 public:
  /// `first` is a capture of the source; it shows which cameras there are. A fisheye whose size is
  /// neither in it nor in `info` is left out. Errors: kUsage for a board that views.toml cannot
  /// hold or a folder that holds something else; kData for captures without depth; kIo.
  static Result<ViewCollector> create(const std::filesystem::path& folder,
                                      const capture::SourceInfo& info,
                                      const capture::Capture& first,
                                      const CollectSettings& settings);

  /// Judges the next capture, and keeps the view that ends with it if it is useful. Swaps the
  /// pictures out of `capture`. Errors: kIo; kUsage for an unknown dictionary.
  Result<CollectState> add(capture::Capture& capture);

  const Coverage& coverage() const { return coverage_; }
  const CollectCounts& counts() const { return counts_; }
  const ViewFolder& folder() const { return folder_; }
  /// Motion in the window that was judged last.
  const BoardMotion& motion() const { return motion_; }
  /// The board in the last kept view, for each camera.
  const SeenBoards& last() const { return coverage_.views().back(); }
  /// Error that says why no view was kept and what to do. `shows`: the board that a picture seems
  /// to show instead, or empty.
  Error why_none(const std::string& shows) const;
  /// Grey picture of the target camera in the last capture.
  ImageView<const std::uint8_t> last_gray() const { return gray_.view(); }
  /// Precondition: at least one view.
  Result<void> finish() { return folder_.finish(); }

 private:
  ViewCollector(ViewFolder folder, Coverage coverage, const CollectSettings& settings,
                double depth_unit_m)
      : folder_(std::move(folder)),
        coverage_(std::move(coverage)),
        settings_(settings),
        depth_unit_m_(depth_unit_m) {}
  Result<std::optional<std::pair<ViewRole, BoardView>>> find(const capture::Capture& capture);
  void push(capture::Capture& capture, BoardView board);
  void forget() { frames_.clear(), boards_.clear(); }
  bool full() const;
  bool too_soon(const capture::Capture& capture) const;
  Result<CollectState> judge_still();
  Result<SeenBoards> boards_in(const StillView& view) const;
  bool rests_in_tof(const BoardView& tof) const;

  ViewFolder folder_;
  Coverage coverage_;
  CollectSettings settings_;
  double depth_unit_m_;
  CollectCounts counts_;
  ViewRole reference_ = ViewRole::kTarget;  ///< camera whose pictures judge the window
  std::vector<capture::Capture> frames_;    ///< frames of the window, oldest first
  std::vector<BoardView> boards_;           ///< the board in each frame, as the reference sees it
  BoardMotion motion_;
  double sharpest_px_ = 0;  ///< least blur of the target camera in a still window; 0: none yet
  Image<std::uint8_t> gray_;
};

}  // namespace mixrig::calibration
