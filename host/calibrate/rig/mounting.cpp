// SPDX-License-Identifier: Apache-2.0
// Mounting of a camera from poses of the board.
#include "host/calibrate/rig/mounting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/base/order_statistics.h"

namespace mixrig::calibration {
namespace {

constexpr std::size_t kLeastShared = 3;
constexpr double kDecided = 3;  // the next numbering must miss this many times as far

/// Pose of the board whose corners are numbered after quarter turns, in its axes before them.
geometry::Pose board_from_turned(const ViewSet& set, int quarter_turns) {
  const Eigen::Quaterniond back(
      Eigen::AngleAxisd(-0.5 * std::numbers::pi * quarter_turns, Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d middle(0.5 * set.columns * set.square_m, 0.5 * set.rows * set.square_m, 0);
  return {back, middle - back * middle};
}

/// Metres and radians together.
double distance_between(const geometry::Pose& a, const geometry::Pose& b) {
  return (a.translation_m - b.translation_m).norm() + a.rotation.angularDistance(b.rotation);
}

/// Mountings by one view, one for each numbering of its corners.
using Numberings = std::vector<geometry::Pose>;

std::size_t nearest_of(const Numberings& numberings, const geometry::Pose& mounting) {
  const auto nearest =
      std::min_element(numberings.begin(), numberings.end(), [&](const auto& a, const auto& b) {
        return distance_between(a, mounting) < distance_between(b, mounting);
      });
  return static_cast<std::size_t>(nearest - numberings.begin());
}

/// Distance of a mounting to each view's nearest numbering.
std::vector<double> misses_of(const std::vector<Numberings>& views,
                              const geometry::Pose& mounting) {
  std::vector<double> misses;
  for (const Numberings& view : views)
    misses.push_back(distance_between(view[nearest_of(view, mounting)], mounting));
  return misses;
}

/// The mounting with the least sum of distances to all views.
geometry::Pose middle_of(const std::vector<Numberings>& views) {
  geometry::Pose best;
  double least = 1e300;
  for (const Numberings& view : views)
    for (const geometry::Pose& mounting : view) {
      double sum = 0;
      for (const double miss : misses_of(views, mounting)) sum += miss;
      if (sum < least) least = sum, best = mounting;
    }
  return best;
}

/// True where no mounting of other numberings agrees with the views nearly as well.
bool is_decided(const std::vector<Numberings>& views, const geometry::Pose& mounting) {
  const double own = upper_median(misses_of(views, mounting));
  for (const Numberings& view : views) {
    const std::size_t chosen = nearest_of(view, mounting);
    for (std::size_t k = 0; k < view.size(); ++k)
      if (k != chosen && upper_median(misses_of(views, view[k])) < kDecided * own) return false;
  }
  return true;
}

}  // namespace

std::vector<int> alike_turns(const ViewSet& set) {
  if (set.board_kind == "charuco" || (set.columns + set.rows) % 2 == 1) return {0};
  if (set.columns == set.rows && set.columns % 2 == 1) return {0, 1, 2, 3};
  return {0, 2};
}

void turn_numbering(const ViewSet& set, int quarter_turns, std::vector<SeenCorner>& corners,
                    geometry::Pose& camera_from_board) {
  const Eigen::Vector2d middle(0.5 * set.columns, 0.5 * set.rows);
  for (SeenCorner& corner : corners)
    for (int k = 0; k < quarter_turns; ++k) {
      const Eigen::Vector2d off = corner.uv - middle;
      corner.uv = middle + Eigen::Vector2d(-off.y(), off.x());
    }
  if (quarter_turns != 0)
    camera_from_board = camera_from_board * board_from_turned(set, quarter_turns);
}

double angle_between(const ViewSet& set, const geometry::Pose& a, const geometry::Pose& b) {
  double least = std::numbers::pi;
  for (const int turns : alike_turns(set))
    least =
        std::min(least, a.rotation.angularDistance((b * board_from_turned(set, turns)).rotation));
  return least;
}

Result<geometry::Pose> find_mounting(RigData& data, const RigModel& rig,
                                     const std::vector<bool>& placed, std::size_t camera,
                                     RigModel& single) {
  const std::vector<int> turns = alike_turns(data.set);
  const auto numberings_of = [&](int view) {
    Numberings numberings;
    for (const int k : turns)
      numberings.push_back(single.target_from_board[view] * board_from_turned(data.set, k) *
                           geometry::inverse(rig.target_from_board[view]));
    return numberings;
  };
  const std::string &target = rig.cameras[0].name, &name = rig.cameras[camera].name;
  std::vector<Numberings> shared;
  for (const int view : seen_by(data, camera))
    if (!data.corners[view][0].empty()) shared.push_back(numberings_of(view));
  if (shared.size() < kLeastShared)
    return Error{ErrorCode::kData, "cameras \"" + target + "\" and \"" + name + "\" share " +
                                       std::to_string(shared.size()) +
                                       " views of the board, but 3 are needed: hold it where both "
                                       "see it"};
  const geometry::Pose mounting = middle_of(shared);
  if (!is_decided(shared, mounting))
    return Error{ErrorCode::kData,
                 "the board looks the same upside down, and the views do not tell how camera \"" +
                     name + "\" is turned against \"" + target +
                     "\": use a board of an odd by an even number of squares, or tilt it to all "
                     "sides"};
  for (const int view : seen_by(data, camera))
    if (placed[view])
      turn_numbering(data.set, turns[nearest_of(numberings_of(view), mounting)],
                     data.corners[view][camera], single.target_from_board[view]);
  return mounting;
}

}  // namespace mixrig::calibration
