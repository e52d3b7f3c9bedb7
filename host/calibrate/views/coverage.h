// SPDX-License-Identifier: Apache-2.0
// Counts what a set of board views covers, and names what it lacks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/calibrate/board/detect_board.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::calibration {

enum class ViewRole { kTarget, kTof, kFisheye };
struct CoveredCamera {
  ViewRole role = ViewRole::kTarget;
  std::string name;
  Size size_px;
};

/// The board in each camera's picture of one view, in the order of the cameras.
using SeenBoards = std::vector<std::optional<BoardView>>;

/// Something that a set of views should show, and how often it does.
struct Need {
  std::string what;  ///< as advice: "hold it nearer"
  int wanted = 0, have = 0;
  bool met() const { return have >= wanted; }
};

/// Counts needs: views that target and depth camera share, ninths of these two pictures, the board
/// tilted by 15 degrees or more to four sides, near (half of the picture's width or height), far
/// (less than a third), and far off the axis of a fisheye. Not thread-safe.
class Coverage {
 public:
  /// `target`: a guess of the target camera's lens, from which tilts are computed. `views`: how
  /// many views target and depth camera should share.
  Coverage(const BoardSpec& board, std::vector<CoveredCamera> cameras,
           const geometry::CameraModel& target, int views);

  /// True where the corners differ from those of each earlier view by 4 % of a picture's diagonal,
  /// root mean square, in a camera that sees both.
  bool is_new(const SeenBoards& seen) const;
  /// Number of unmet needs that the view would serve.
  int gain(const SeenBoards& seen) const;
  void add(SeenBoards seen);

  bool enough() const;
  const std::vector<Need>& needs() const { return needs_; }
  const std::vector<SeenBoards>& views() const { return views_; }
  const std::vector<CoveredCamera>& cameras() const { return cameras_; }
  int shared() const { return needs_.front().have; }
  /// Next step for the user in a few words; empty when nothing is missing.
  std::string advice() const;

 private:
  std::vector<bool> served_by(const SeenBoards& seen) const;

  BoardSpec board_;
  std::vector<CoveredCamera> cameras_;
  geometry::CameraModel target_;
  std::vector<Need> needs_;  ///< in the order of served_by()
  std::vector<SeenBoards> views_;
};

/// Right and down components of the board's unit normal that points to the camera; nullopt where
/// the corners do not determine it.
std::optional<Eigen::Vector2d> board_tilt(const BoardView& seen, const BoardSpec& board,
                                          const geometry::CameraModel& camera);

}  // namespace mixrig::calibration
