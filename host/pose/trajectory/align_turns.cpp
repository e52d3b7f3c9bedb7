// SPDX-License-Identifier: Apache-2.0
#include "host/pose/trajectory/align_turns.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using estimation::skew;

std::vector<Row> rows_of(const Pair& pair, const State& state) {
  std::vector<Row> rows;
  const double probe_s = 0.25 * pair.moving.median_step_s();
  for (std::size_t i = 0; i < pair.windows.size(); ++i) {
    const auto moving = probed(pair.moving, shifted(pair.windows[i], state.offset_s), probe_s);
    if (!moving) continue;
    Row row{pair.windows[i].from_s, moving->at.turn_rad, pair.fixed_motions[i].turn_rad, {}, {}, 1};
    const Vector3d predicted = state.rotation * row.fixed;
    row.residual = row.moving - predicted;
    row.slope.col(0) = (moving->after.turn_rad - moving->before.turn_rad) / (2 * probe_s);
    row.slope.rightCols<3>() = skew(predicted);
    rows.push_back(row);
  }
  return rows;
}

void weigh(std::vector<Row>& rows) {
  const double sigma = coordinate_sigma(median_residual(rows));
  for (Row& row : rows) row.weight = cauchy_weight(row.residual.norm(), sigma);
}

Eigen::Quaterniond best_rotation(const std::vector<Row>& rows) {
  Matrix3d cross = Matrix3d::Zero();
  for (const Row& row : rows) cross += row.weight * row.moving * row.fixed.transpose();
  return estimation::fit_rotation(cross).rotation;
}

/// Refines by iteratively reweighted Gauss-Newton from a coarse offset. Its first steps solve for
/// the rotation in closed form, so `state` needs no start rotation.
std::vector<Row> refine(const Pair& pair, State& state, int max_steps) {
  std::vector<Row> rows;
  constexpr int kRotationSteps = 4;
  for (int step = 0; step < max_steps; ++step) {
    rows = rows_of(pair, state);
    if (rows.size() < 4) return rows;
    if (step < kRotationSteps) {
      state.rotation = best_rotation(rows);
      for (Row& row : rows) {
        const Vector3d predicted = state.rotation * row.fixed;
        row.residual = row.moving - predicted;
        row.slope.rightCols<3>() = skew(predicted);
      }
    }
    weigh(rows);
    Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    for (const Row& row : rows) {
      h += row.weight * row.slope.transpose() * row.slope;
      g += row.weight * row.slope.transpose() * row.residual;
    }
    Eigen::Vector4d delta = -h.ldlt().solve(g);
    if (!delta.allFinite()) return rows;
    constexpr double kLongestStep_s = 0.05;
    delta *= std::min(1.0, kLongestStep_s / std::max(std::abs(delta[0]), 1e-12));
    state.offset_s += delta[0];
    state.rotation = (estimation::rotation_exp(delta.tail<3>()) * state.rotation).normalized();
    if (step >= kRotationSteps && std::abs(delta[0]) < 1e-7 && delta.tail<3>().norm() < 1e-7) break;
  }
  rows = rows_of(pair, state);
  weigh(rows);
  return rows;
}

}  // namespace

std::optional<Probed> probed(const Trajectory& moving, const Window& at, double probe_s) {
  const auto motion = motion_over(moving, at);
  const auto before = motion_over(moving, shifted(at, -probe_s));
  const auto after = motion_over(moving, shifted(at, probe_s));
  if (!motion || !before || !after) return std::nullopt;
  return Probed{*motion, *before, *after};
}

Pair make_pair(const Trajectory& moving, const Trajectory& fixed, double window_s) {
  Pair pair{moving, fixed, {}, {}};
  for (const Window& window : windows_of(fixed, window_s)) {
    const auto motion = motion_over(fixed, window);
    if (!motion) continue;
    pair.windows.push_back(window);
    pair.fixed_motions.push_back(*motion);
  }
  return pair;
}

Window shifted(const Window& w, double by_s) { return {w.from_s + by_s, w.to_s + by_s}; }

double cauchy_weight(double length, double sigma) {
  return 1 / (1 + std::pow(length / (4 * sigma), 2));
}

double coordinate_sigma(double median_length) { return std::max(median_length / 1.538, 1e-9); }

double median_residual(const std::vector<Row>& rows) {
  std::vector<double> lengths;
  for (const Row& row : rows) lengths.push_back(row.residual.norm());
  return upper_median(std::move(lengths));
}

std::vector<Row> weighted_rows(const Pair& pair, const State& state) {
  auto rows = rows_of(pair, state);
  weigh(rows);
  return rows;
}

std::vector<Solution> solutions_of(const Pair& pair, std::span<const OffsetCandidate> candidates) {
  std::vector<Solution> solutions;
  for (const OffsetCandidate& candidate : candidates) {
    Solution s{{candidate.offset_s, {}}, {}, 0};
    constexpr int kCoarseSteps = 8;
    s.rows = refine(pair, s.state, kCoarseSteps);
    constexpr std::size_t kFewestRows = 30;
    if (s.rows.size() < kFewestRows) continue;
    s.residual_rad = median_residual(s.rows);
    solutions.push_back(std::move(s));
  }
  std::sort(solutions.begin(), solutions.end(),
            [](const Solution& x, const Solution& y) { return x.residual_rad < y.residual_rad; });
  if (solutions.empty()) return solutions;
  constexpr int kFineSteps = 40;
  Solution& best = solutions.front();
  best.rows = refine(pair, best.state, kFineSteps);
  best.residual_rad = median_residual(best.rows);
  return solutions;
}

}  // namespace mixrig::trajectory
