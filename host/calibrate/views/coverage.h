// SPDX-License-Identifier: Apache-2.0
// What a set of board views covers, and what it lacks.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/calibrate/board/detect_board.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::calibration {

/// A camera whose pictures are to be covered.
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
/// tilted by 15 degrees or more to four sides, near (half of the picture's width or height) and far
/// (less than a third), and far off the axis before a fisheye. Not thread-safe.
class Coverage {
 public:
  /// `target` is a guess of the target camera's lens, for the tilt; `views`: how many views target
  /// and depth camera are to share.
  Coverage(const BoardSpec& board, std::vector<CoveredCamera> cameras,
           const geometry::CameraModel& target, int views);

  /// True where the corners differ from those of each view so far by 4 % of a picture's diagonal,
  /// root mean square, in a camera that sees both.
  bool is_new(const SeenBoards& seen) const;
  /// How many needs that are not met yet the view serves.
  int gain(const SeenBoards& seen) const;
  void add(SeenBoards seen);

  bool enough() const;
  const std::vector<Need>& needs() const { return needs_; }
  const std::vector<SeenBoards>& views() const { return views_; }
  const std::vector<CoveredCamera>& cameras() const { return cameras_; }
  int shared() const { return needs_.front().have; }
  /// What to do next, in a few words; empty where it is enough.
  std::string advice() const;

 private:
  std::vector<bool> served_by(const SeenBoards& seen) const;

  BoardSpec board_;
  std::vector<CoveredCamera> cameras_;
  geometry::CameraModel target_;
  std::vector<Need> needs_;  ///< in the order of served_by()
  std::vector<SeenBoards> views_;
};

/// Where a board's normal points: right and down components of the unit normal that points to the
/// camera; nullopt where the corners do not tell.
std::optional<Eigen::Vector2d> board_tilt(const BoardView& seen, const BoardSpec& board,
                                          const geometry::CameraModel& camera);

}  // namespace mixrig::calibration
