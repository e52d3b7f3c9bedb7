// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/views/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/math/estimation/pose/pnp.h"

namespace mixrig::calibration {
namespace {

constexpr int kSide = 3;             ///< cells of a picture, a side
constexpr double kCellShare = 0.08;  ///< of the corners, that make a cell covered
constexpr double kTilted = 0.2588;   ///< sine of 15 degrees
constexpr double kNearShare = 0.5, kFarShare = 0.33;
constexpr double kAsideShare = 0.18;  ///< of a fisheye's height: some 33 degrees of 185
constexpr double kNewShare = 0.04;
constexpr int kCellWanted = 2, kTofCellWanted = 1, kTiltWanted = 2, kDistanceWanted = 3,
              kAsideWanted = 4;

constexpr std::array<const char*, kSide> kRows{"top", "middle", "bottom"},
    kColumns{"left", "middle", "right"};
constexpr std::array<const char*, 4> kTilts{
    "turn its right side towards the cameras", "turn its left side towards the cameras",
    "tilt its bottom towards the cameras", "tilt its top towards the cameras"};

std::string cell_name(int row, int column) {
  if (row == 1 && column == 1) return "middle";
  return fmt::format("{} {}", kRows[static_cast<std::size_t>(row)],
                     kColumns[static_cast<std::size_t>(column)]);
}

Eigen::Vector2d size_of(const CoveredCamera& camera) {
  return {camera.size_px.width, camera.size_px.height};
}

/// Cells that hold enough of the corners, row by row.
std::array<bool, kSide * kSide> cells_of(const BoardView& seen, const CoveredCamera& camera) {
  std::array<int, kSide * kSide> count{};
  for (const Eigen::Vector2d& px : seen.px) {
    const auto cell = [](double at, double size) {
      return std::clamp(static_cast<int>(kSide * (at + 0.5) / size), 0, kSide - 1);
    };
    ++count[static_cast<std::size_t>(kSide * cell(px.y(), camera.size_px.height) +
                                     cell(px.x(), camera.size_px.width))];
  }
  std::array<bool, kSide * kSide> covered{};
  for (std::size_t i = 0; i < count.size(); ++i)
    covered[i] = count[i] > 0 && count[i] >= kCellShare * static_cast<double>(seen.px.size());
  return covered;
}

/// The larger share of the picture's width and height that the corners span.
double share_of(const BoardView& seen, const CoveredCamera& camera) {
  Eigen::Vector2d low = seen.px.front(), high = low;
  for (const Eigen::Vector2d& px : seen.px) low = low.cwiseMin(px), high = high.cwiseMax(px);
  return (high - low).cwiseQuotient(size_of(camera)).maxCoeff();
}

bool is_aside(const BoardView& seen, const CoveredCamera& camera) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& px : seen.px) mean += px / static_cast<double>(seen.px.size());
  return (mean - 0.5 * size_of(camera)).norm() > kAsideShare * camera.size_px.height;
}

/// Root mean square distance of the corners that both show, over the picture's diagonal; 0 where
/// they show none in common.
double change(const BoardView& a, const BoardView& b, const CoveredCamera& camera) {
  double square = 0;
  int count = 0;
  for (std::size_t i = 0, j = 0; i < a.ids.size() && j < b.ids.size();) {
    if (a.ids[i] == b.ids[j]) {
      square += (a.px[i++] - b.px[j++]).squaredNorm();
      ++count;
    } else {
      ++(a.ids[i] < b.ids[j] ? i : j);
    }
  }
  return count == 0 ? 0 : std::sqrt(square / count) / size_of(camera).norm();
}

}  // namespace

std::optional<Eigen::Vector2d> board_tilt(const BoardView& seen, const BoardSpec& board,
                                          const geometry::CameraModel& camera) {
  const std::vector<Eigen::Vector3d> points = board_points_m(board);
  std::vector<Eigen::Vector3d> at_m;
  std::vector<estimation::Bearing> bearings;
  constexpr double kLensGuess_px = 2;  ///< the lens is a guess: corners lie as far from its model
  for (std::size_t i = 0; i < seen.ids.size(); ++i)
    if (const auto bearing = estimation::bearing_of(camera, seen.px[i], kLensGuess_px)) {
      at_m.push_back(points[static_cast<std::size_t>(seen.ids[i])]);
      bearings.push_back(*bearing);
    }
  const auto pose = estimation::solve_pnp(at_m, bearings);
  if (pose.verdict.standing == estimation::Standing::kDegenerate) return std::nullopt;
  const Eigen::Vector3d away = pose.value.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d normal = away.z() > 0 ? -away : away;  // towards the camera
  return normal.head<2>();
}

Coverage::Coverage(const BoardSpec& board, std::vector<CoveredCamera> cameras,
                   const geometry::CameraModel& target, int views)
    : board_(board), cameras_(std::move(cameras)), target_(target) {
  needs_.push_back({"show it to all cameras at another place", views});
  for (const CoveredCamera& camera : cameras_) {
    if (camera.role == ViewRole::kFisheye) continue;
    const int wanted = camera.role == ViewRole::kTarget ? kCellWanted : kTofCellWanted;
    for (int row = 0; row < kSide; ++row)
      for (int column = 0; column < kSide; ++column)
        needs_.push_back({fmt::format("hold it at the {} of the {} picture", cell_name(row, column),
                                      camera.name),
                          wanted});
  }
  for (const char* tilt : kTilts) needs_.push_back({tilt, kTiltWanted});
  needs_.push_back({"hold it nearer", kDistanceWanted});
  needs_.push_back({"hold it farther away", kDistanceWanted});
  for (const CoveredCamera& camera : cameras_)
    if (camera.role == ViewRole::kFisheye)
      needs_.push_back({"show it to the fisheye, far to a side", kAsideWanted});
}

std::vector<bool> Coverage::served_by(const SeenBoards& seen) const {
  std::vector<bool> served;
  bool shared = true;
  for (std::size_t c = 0; c < cameras_.size(); ++c)
    if (cameras_[c].role != ViewRole::kFisheye) shared = shared && seen[c];
  served.push_back(shared);
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    if (cameras_[c].role == ViewRole::kFisheye) continue;
    std::array<bool, kSide * kSide> cells{};
    if (seen[c]) cells = cells_of(*seen[c], cameras_[c]);
    served.insert(served.end(), cells.begin(), cells.end());
  }
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();
  double share = 0;
  if (seen[0]) {
    tilt = board_tilt(*seen[0], board_, target_).value_or(tilt);
    share = share_of(*seen[0], cameras_[0]);
  }
  // A normal that points to the left shows that the right side is nearer.
  served.insert(served.end(),
                {tilt.x() < -kTilted, tilt.x() > kTilted, tilt.y() < -kTilted, tilt.y() > kTilted});
  served.insert(served.end(), {share >= kNearShare, share > 0 && share < kFarShare});
  for (std::size_t c = 0; c < cameras_.size(); ++c)
    if (cameras_[c].role == ViewRole::kFisheye)
      served.push_back(seen[c] && is_aside(*seen[c], cameras_[c]));
  return served;
}

bool Coverage::is_new(const SeenBoards& seen) const {
  for (const SeenBoards& known : views_) {
    double most = 0;
    bool both = false;
    for (std::size_t c = 0; c < cameras_.size(); ++c)
      if (seen[c] && known[c]) {
        both = true;
        most = std::max(most, change(*seen[c], *known[c], cameras_[c]));
      }
    if (both && most < kNewShare) return false;
  }
  return true;
}

int Coverage::gain(const SeenBoards& seen) const {
  const std::vector<bool> served = served_by(seen);
  int gain = 0;
  for (std::size_t i = 0; i < served.size(); ++i) gain += served[i] && !needs_[i].met() ? 1 : 0;
  return gain;
}

void Coverage::add(SeenBoards seen) {
  const std::vector<bool> served = served_by(seen);
  for (std::size_t i = 0; i < served.size(); ++i) needs_[i].have += served[i] ? 1 : 0;
  views_.push_back(std::move(seen));
}

bool Coverage::enough() const {
  return std::all_of(needs_.begin(), needs_.end(), [](const Need& need) { return need.met(); });
}

std::string Coverage::advice() const {
  // The rarest first; another place serves any of them.
  const Need* next = nullptr;
  for (std::size_t i = 1; i < needs_.size(); ++i)
    if (!needs_[i].met() && (next == nullptr || needs_[i].have < next->have)) next = &needs_[i];
  if (next == nullptr && !needs_.front().met()) next = &needs_.front();
  return next == nullptr ? "" : next->what;
}

}  // namespace mixrig::calibration
