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
  int views = 15;  ///< that target and depth camera are to share
  int frames = 8;  ///< in a row that must show a board at rest; their mean is the view; 3..64
  Duration still_time = std::chrono::milliseconds(250);  ///< at least, from the first to the last
  double rest_px = 0.25;     ///< motion of the board in a picture that counts as rest
  double rest_m = 0.002;     ///< the same in depth
  bool every_place = false;  ///< the cameras turn before a fixed board: each new place is kept
  double step_rad = 0;       ///< of the pan-tilt unit, for views.toml; 0: not known
};

/// What became of a capture.
enum class CollectState {
  kNoBoard,   ///< neither the target camera nor the fisheye sees it
  kSettling,  ///< too few frames yet
  kMoving,
  kBlurred,  ///< or out of focus: by far less sharp than views before
  kKnown,    ///< still, but it adds nothing
  kKept
};

struct CollectCounts {
  int frames = 0, in_target = 0, in_fisheye = 0;
  int still = 0;                        ///< windows of a board at rest
  int without_tof = 0, moving_tof = 0;  ///< of the still ones: the depth camera does not see it,
                                        ///< or sees it move
  int blurred = 0;
  double least_motion_px = 0;  ///< of a whole window that was not at rest; 0: there was none
};

/// One thread. Nothing is written but into the folder's temporary name until finish().
class ViewCollector {
 public:
  /// `first` is a capture of the source, which tells what cameras there are; a fisheye whose size
  /// neither it nor `info` tells is left out. Errors: kUsage for a
  /// board that views.toml cannot hold or a folder that holds something else; kData for captures
  /// without depth; kIo.
  static Result<ViewCollector> create(const std::filesystem::path& folder,
                                      const capture::SourceInfo& info,
                                      const capture::Capture& first,
                                      const CollectSettings& settings);

  /// Judges the next capture, and keeps the view that ends with it where it is of use. Swaps the
  /// pictures out of `capture`. Errors: kIo; kUsage for a dictionary that is not known.
  Result<CollectState> add(capture::Capture& capture);

  const Coverage& coverage() const { return coverage_; }
  const CollectCounts& counts() const { return counts_; }
  const ViewFolder& folder() const { return folder_; }
  /// Of the window that was judged last.
  const BoardMotion& motion() const { return motion_; }
  /// The board in the last kept view, a camera.
  const SeenBoards& last() const { return coverage_.views().back(); }
  /// Why no view was kept, with what to do. `shows`: the board that a picture seems to show
  /// instead, or empty.
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
  ViewRole reference_ = ViewRole::kTarget;  ///< whose picture the window is judged in
  std::vector<capture::Capture> frames_;    ///< of the window, oldest first
  std::vector<BoardView> boards_;           ///< in them, as the reference sees it
  BoardMotion motion_;
  double sharpest_px_ = 0;  ///< least blur of a still window of the target camera; 0: none yet
  Image<std::uint8_t> gray_;
};

}  // namespace mixrig::calibration
