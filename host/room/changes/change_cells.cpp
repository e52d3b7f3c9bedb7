// SPDX-License-Identifier: Apache-2.0
#include "host/room/changes/change_cells.h"

#include <algorithm>
#include <cmath>

namespace mixrig::model {
namespace {

/// A cell ends when frames disagree for so long at a stretch, or in all for more than a part of the
/// time in which they agreed.
constexpr float kLongestStreak_s = 1, kLeastAgainst_s = 0.2F, kMostAgainstPart = 0.1F;
/// Parts of a step: what is farther is seen through, what is nearer is there, between says nothing.
constexpr float kBeyondPart = 0.7F, kTherePart = 0.4F;
/// Time over which the unrest of a cell is averaged.
constexpr double kUnrest_s = 4;
/// Time over which its depth is averaged before.
constexpr double kSway_s = 0.6;
/// Metres around the room's surfaces that still belong to it.
constexpr double kRoomMargin_m = 0.3;

}  // namespace

ChangeCells::ChangeCells(Kind kind, const Eigen::AlignedBox3d& room_m)
    : kind_(kind),
      origin_m_(room_m.min().array() - kRoomMargin_m),
      voxel_m_(kLeastVoxel_m),
      cells_(kMostCells) {
  const Eigen::Array3d extent_m = room_m.sizes().array() + 2 * kRoomMargin_m;
  voxel_m_ = std::max(voxel_m_, std::cbrt(extent_m.prod() / kMostVoxels));
  size_ = (extent_m / voxel_m_).ceil().cast<int>().max(1);
  slots_.assign(static_cast<std::size_t>(size_.prod()), 0);
  free_.reserve(kMostCells);
  for (std::size_t i = kMostCells; i-- > 0;) free_.push_back(static_cast<std::int32_t>(i));
}

bool ChangeCells::voxel_of(const Eigen::Vector3d& world_m, Eigen::Array3i& voxel) const {
  const Eigen::Array3d at = (world_m - origin_m_).array() / voxel_m_;
  if (!(at >= 0).all() || !(at < size_.cast<double>()).all()) return false;
  voxel = at.cast<int>();
  return true;
}

void ChangeCells::free(ChangeCell& cell) {
  slots_[static_cast<std::size_t>(cell.slot)] = 0;
  cell.slot = -1;
  free_.push_back(static_cast<std::int32_t>(&cell - cells_.data()));
}

void ChangeCells::add(const FrameSight& sight, double dt_s) {
  for (ChangeCell& cell : cells_)
    if (cell.slot >= 0) check(sight, dt_s, cell);
  for (int y = 0; y < sight.height(); ++y)
    for (int x = 0; x < sight.width(); ++x) {
      if (kind_ == Kind::kSurface && sight.compare(x, y) == FrameSight::Beside::kNearer)
        note(sight.world(x, y, sight.steady_m(x, y)), sight.frame().time_s);
      if (kind_ == Kind::kHole && sight.is_seen_through(x, y))
        note(sight.world(x, y, sight.frame().model_depth_m.row(y)[x]), sight.frame().time_s);
    }
}

/// Measures the slow motion of a cell's surface by less than a depth step: a standing person sways,
/// an object does not. Noise is averaged out over kSway_s first, since swaying is slower than that.
void ChangeCells::note_unrest(float off_m, double dt_s, ChangeCell& cell) {
  ChangeCell::Half& half = cell.halves[static_cast<std::size_t>(cell.looks % 2)];
  const float frames = static_cast<float>(cell.looks++ / 2 + 1);
  const auto share_of = [&](double time_s) {
    return std::max(std::min(static_cast<float>(2 * dt_s / time_s), 1.0F), 1 / frames);
  };
  half.smooth_m += share_of(kSway_s) * (off_m - half.smooth_m);
  half.mean_m += share_of(kUnrest_s) * (half.smooth_m - half.mean_m);
  if (cell.looks < 2) return;
  const auto& [a, b] = cell.halves;
  const float share = std::min(static_cast<float>(dt_s / kUnrest_s), 1.0F);
  const float both_m2 = (a.smooth_m - a.mean_m) * (b.smooth_m - b.mean_m);
  cell.covariance_m2 += share * (both_m2 - cell.covariance_m2);
  cell.weight += share * (1 - cell.weight);
}

/// Checks a cell against a frame; a frame in which something hides the cell is ignored.
void ChangeCells::check(const FrameSight& sight, double dt_s, ChangeCell& cell) {
  int x = 0, y = 0;
  float z_m = 0;
  if (!sight.find(cell.point_m.cast<double>(), x, y, z_m)) return;
  const float seen_m = kind_ == Kind::kHole ? sight.nearest_m(x, y) : sight.mean_m(x, y);
  if (!(seen_m > 0)) return;
  const float step_m = sight.step_m(z_m), off_m = seen_m - z_m;
  if (off_m < -step_m) return;
  const bool beyond = off_m > kBeyondPart * step_m;
  if (kind_ == Kind::kHole && beyond && !(sight.steady_m(x, y) > 0)) return;
  if (kind_ == Kind::kSurface && !beyond) note_unrest(off_m, dt_s, cell);
  if (!beyond && off_m > kTherePart * step_m) return;
  const auto dt = static_cast<float>(dt_s);
  if (beyond == (kind_ == Kind::kHole)) {
    cell.held_s += dt;
    cell.streak_s = 0;
    cell.seen_s = sight.frame().time_s;
    return;
  }
  cell.against_s += dt;
  cell.streak_s += dt;
  if (cell.streak_s > kLongestStreak_s ||
      cell.against_s > kLeastAgainst_s + kMostAgainstPart * cell.held_s)
    free(cell);
}

void ChangeCells::note(const Eigen::Vector3d& world_m, double time_s) {
  Eigen::Array3i voxel;
  if (!voxel_of(world_m, voxel)) return;
  std::int32_t& slot = slots_[static_cast<std::size_t>(slot_of(voxel))];
  if (slot == 0) {
    if (free_.empty()) return;
    slot = free_.back() + 1;
    free_.pop_back();
    ChangeCell& cell = cells_[static_cast<std::size_t>(slot - 1)];
    cell = {};
    cell.slot = slot_of(voxel);
    cell.first_s = cell.seen_s = time_s;
  }
  ChangeCell& cell = cells_[static_cast<std::size_t>(slot - 1)];
  if (cell.first_s != time_s) return;
  ++cell.points;
  cell.point_m += (world_m.cast<float>() - cell.point_m) / static_cast<float>(cell.points);
}

}  // namespace mixrig::model
