// SPDX-License-Identifier: Apache-2.0
// Cells of the room in which frames disagree with the model, and for how long. Private to this
// folder.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "host/room/changes/watch_frame.h"

namespace mixrig::model {

/// A cube of the room: it holds a surface that the model lacks, or a surface of the model that
/// frames see through.
struct ChangeCell {
  Eigen::Vector3f point_m{0, 0, 0};  ///< mean of the surface, world
  float held_s = 0;                  ///< time in which frames confirmed it
  float against_s = 0;               ///< time in which frames contradicted it
  float streak_s = 0;                ///< part of against_s since frames last confirmed it
  double first_s = 0, seen_s = 0;
  /// Measured z less z of the point. Frames alternate between two halves with independent noise, so
  /// that the covariance of the halves' averages comes from movement alone.
  struct Half {
    float smooth_m = 0;  ///< short-term average
    float mean_m = 0;    ///< long-term average
  };
  std::array<Half, 2> halves{};
  int looks = 0;
  /// Recent covariance of the halves; weight below 1: younger than the average.
  float covariance_m2 = 0, weight = 0;
  int points = 0;  ///< number of points averaged in point_m
  int change = 0;  ///< number of the change that it belongs to; 0: none
  int slot = -1;   ///< index in the grid; -1: not in use
};

/// Grid of one kind of evidence. Memory is constant: at most kMostVoxels voxels of at least
/// kLeastVoxel_m, and kMostCells cells in use. Not thread-safe; allocates in the constructor only.
class ChangeCells {
 public:
  enum class Kind { kSurface, kHole };
  static constexpr double kLeastVoxel_m = 0.06;
  static constexpr double kMostVoxels = 2e6;
  static constexpr std::size_t kMostCells = 32768;

  ChangeCells(Kind kind, const Eigen::AlignedBox3d& room_m);

  /// Compares the cells with a frame `dt_s` after the last one, and adds new cells.
  void add(const FrameSight& sight, double dt_s);
  double voxel_m() const { return voxel_m_; }
  std::span<ChangeCell> cells() { return cells_; }
  std::span<const ChangeCell> cells() const { return cells_; }
  /// Calls visit(index) for cells in use within `reach` voxels of a point along each axis, until it
  /// returns false.
  template <typename Visit>
  void around(const Eigen::Vector3d& world_m, int reach, Visit&& visit) const;
  void free(ChangeCell& cell);

 private:
  bool voxel_of(const Eigen::Vector3d& world_m, Eigen::Array3i& voxel) const;
  int slot_of(const Eigen::Array3i& voxel) const {
    return (voxel.z() * size_.y() + voxel.y()) * size_.x() + voxel.x();
  }
  void check(const FrameSight& sight, double dt_s, ChangeCell& cell);
  static void note_unrest(float off_m, double dt_s, ChangeCell& cell);
  void note(const Eigen::Vector3d& world_m, double time_s);

  const Kind kind_;
  Eigen::Vector3d origin_m_;
  double voxel_m_;
  Eigen::Array3i size_;
  std::vector<std::int32_t> slots_;  ///< index of a cell + 1; 0: none
  std::vector<ChangeCell> cells_;
  std::vector<std::int32_t> free_;
};

template <typename Visit>
void ChangeCells::around(const Eigen::Vector3d& world_m, int reach, Visit&& visit) const {
  Eigen::Array3i voxel;
  if (!voxel_of(world_m, voxel)) return;
  const Eigen::Array3i first = (voxel - reach).max(0), last = (voxel + reach).min(size_ - 1);
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x) {
        const std::int32_t index = slots_[static_cast<std::size_t>(slot_of({x, y, z}))];
        if (index > 0 && !visit(static_cast<std::size_t>(index - 1))) return;
      }
}

}  // namespace mixrig::model
