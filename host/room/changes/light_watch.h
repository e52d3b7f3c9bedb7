// SPDX-License-Identifier: Apache-2.0
// Watches the brightness of surfaces that are where the model has them. Private to this folder.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "host/room/changes/watch_frame.h"

namespace mixrig::model {

/// Recent light of the room relative to the model's.
struct LightState {
  Eigen::Array3d factor{1, 1, 1};  ///< median over the room; linear red, green, blue
  double uneven_share = 0;         ///< share of the room that is off that factor by kUneven
  int patches = 0;                 ///< number of patches seen recently
};

/// Divides the room into cubes and averages the ratio of measured to model colour in each. Constant
/// memory; allocates in the constructor only. Not thread-safe.
class LightWatch {
 public:
  static constexpr double kLeastPatch_m = 0.3;
  static constexpr double kMostPatches = 65536;
  static constexpr double kUneven = 1.3;  ///< as a factor, or its inverse
  /// A patch whose colour is off the others' by this factor has changed by itself.
  static constexpr double kOwnColor = 1.5;

  struct Patch {
    Eigen::Array3d sum_seen{0, 0, 0}, sum_model{0, 0, 0};  ///< sums over the current frame
    int samples = 0;
    Eigen::Array3d log_factor{0, 0, 0};
    double first_s = 0, seen_s = -1;
    double off_s = 0;  ///< time in which its colour was off the others'
    int change = 0;    ///< number of the change that it belongs to; 0: none
  };

  explicit LightWatch(const Eigen::AlignedBox3d& room_m);
  void add(const FrameSight& sight, double dt_s);
  /// State of the light, by the patches seen within the last 1.5 s.
  const LightState& state() const { return state_; }
  double patch_m() const { return patch_m_; }
  Eigen::Vector3d center_m(std::size_t patch) const;
  std::vector<Patch>& patches() { return patches_; }
  void forget();

 private:
  void sum_up(const FrameSight& sight);
  void take_in(double time_s, double dt_s);
  void find_state(double time_s);

  Eigen::Vector3d origin_m_;
  double patch_m_;
  Eigen::Array3i size_;
  std::vector<Patch> patches_;
  std::vector<std::size_t> touched_, recent_;
  std::vector<double> values_;
  LightState state_;
};

}  // namespace mixrig::model
