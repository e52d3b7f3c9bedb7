// SPDX-License-Identifier: Apache-2.0
// Alignment of the rotations of two trajectories: time offset and rotation together. Private to
// this module.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/pose/trajectory/relative_motion.h"

namespace mixrig::trajectory {

/// Two trajectories: `fixed` keeps its samples, `moving` is interpolated at t_fixed + offset_s.
struct Pair {
  const Trajectory& moving;
  const Trajectory& fixed;
  std::vector<Window> windows;
  std::vector<Motion> fixed_motions;  ///< motion of `fixed` over each window
};
Pair make_pair(const Trajectory& moving, const Trajectory& fixed, double window_s);

/// The unknowns of the fit: t_moving = t_fixed + offset_s, v_moving = rotation * v_fixed.
struct State {
  double offset_s = 0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// One pair of relative rotations: residual, and its slopes against (offset, small rotation).
struct Row {
  double t_s;
  Eigen::Vector3d moving, fixed, residual;
  Eigen::Matrix<double, 3, 4> slope;
  double weight = 1;
};

/// Result of the fit from one start offset.
struct Solution {
  State state;
  std::vector<Row> rows;
  double residual_rad = 0;  ///< median residual
};

Window shifted(const Window& window, double by_s);

/// A motion over a window, and over the window `probe_s` earlier and later, which gives its
/// derivative by the offset.
struct Probed {
  Motion at, before, after;
};
/// Computes these motions; empty if the trajectory has a gap.
std::optional<Probed> probed(const Trajectory& moving, const Window& at, double probe_s);

/// Returns the Cauchy weight of a residual of this length; `sigma` is that of one coordinate.
double cauchy_weight(double length, double sigma);
/// Returns the sigma of one coordinate from the median length of 3-vectors.
double coordinate_sigma(double median_length);
/// Returns the weighted rows at `state`.
std::vector<Row> weighted_rows(const Pair& pair, const State& state);
double median_residual(const std::vector<Row>& rows);

/// Solves iteratively reweighted least squares from each offset; the best solution, refined, comes
/// first.
std::vector<Solution> solutions_of(const Pair& pair, std::span<const OffsetCandidate> candidates);

}  // namespace mixrig::trajectory
