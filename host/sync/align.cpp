// SPDX-License-Identifier: Apache-2.0
#include "host/sync/align.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include <Eigen/Dense>

#include "host/sync/relative_motion.h"

namespace mixrig::sync {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using estimation::skew;
using Estimate = estimation::Estimate<Alignment>;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// `fixed` keeps its samples, `moving` is interpolated at t_fixed + offset_s.
struct Pair {
  const Trajectory& moving;
  const Trajectory& fixed;
  std::vector<Window> windows;
  std::vector<Motion> fixed_motions;  // over each window
};

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

/// What is sought: t_moving = t_fixed + offset_s, v_moving = rotation * v_fixed.
struct State {
  double offset_s = 0;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// One pair of relative rotations: residual, and its slopes against (offset, small rotation).
struct Row {
  double t_s;
  Vector3d moving, fixed, residual;
  Eigen::Matrix<double, 3, 4> slope;
  double weight = 1;
};

Window shifted(const Window& w, double by_s) { return {w.from_s + by_s, w.to_s + by_s}; }

std::vector<Row> rows_of(const Pair& pair, const State& state) {
  std::vector<Row> rows;
  const double probe_s = 0.25 * pair.moving.median_step_s();
  for (std::size_t i = 0; i < pair.windows.size(); ++i) {
    const Window at = shifted(pair.windows[i], state.offset_s);
    const auto moving = motion_over(pair.moving, at);
    const auto before = motion_over(pair.moving, shifted(at, -probe_s));
    const auto after = motion_over(pair.moving, shifted(at, probe_s));
    if (!moving || !before || !after) continue;
    Row row{pair.windows[i].from_s, moving->turn_rad, pair.fixed_motions[i].turn_rad, {}, {}, 1};
    const Vector3d predicted = state.rotation * row.fixed;
    row.residual = row.moving - predicted;
    row.slope.col(0) = (after->turn_rad - before->turn_rad) / (2 * probe_s);
    row.slope.rightCols<3>() = skew(predicted);
    rows.push_back(row);
  }
  return rows;
}

double median_residual(const std::vector<Row>& rows) {
  std::vector<double> lengths;
  for (const Row& row : rows) lengths.push_back(row.residual.norm());
  return median(std::move(lengths));
}

/// Cauchy weights; the scale is that of one coordinate behind the median length.
void weigh(std::vector<Row>& rows) {
  const double sigma = std::max(median_residual(rows) / 1.538, 1e-9);
  for (Row& row : rows) row.weight = 1 / (1 + row.residual.squaredNorm() / std::pow(4 * sigma, 2));
}

Eigen::Quaterniond best_rotation(const std::vector<Row>& rows) {
  Matrix3d cross = Matrix3d::Zero();
  for (const Row& row : rows) cross += row.weight * row.moving * row.fixed.transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  return Eigen::Quaterniond(
      Matrix3d(svd.matrixU() * Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose()));
}

/// Iteratively reweighted Gauss-Newton from a coarse offset. Its first steps solve the rotation
/// outright, for which `state` need hold none.
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

/// Sandwich covariance with Bartlett weights over twice the window.
Eigen::Matrix4d covariance_of(const std::vector<Row>& rows, double window_s) {
  Eigen::Matrix4d h = Eigen::Matrix4d::Zero(), s = Eigen::Matrix4d::Zero();
  std::vector<Eigen::Vector4d> scores;
  for (const Row& row : rows) {
    h += row.weight * row.slope.transpose() * row.slope;
    scores.push_back(row.weight * row.slope.transpose() * row.residual);
  }
  const double reach_s = 2 * window_s;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    s += scores[i] * scores[i].transpose();
    for (std::size_t j = i + 1; j < rows.size() && rows[j].t_s - rows[i].t_s < reach_s; ++j) {
      const double share = 1 - (rows[j].t_s - rows[i].t_s) / reach_s;
      s += share * (scores[i] * scores[j].transpose() + scores[j] * scores[i].transpose());
    }
  }
  const Eigen::Matrix4d inverse = h.inverse();
  return inverse * s * inverse;
}

/// Root mean square turn about the second most used axis, and about the most used, rad.
Eigen::Vector2d axis_spread(const std::vector<Row>& rows) {
  Matrix3d scatter = Matrix3d::Zero();
  for (const Row& row : rows) scatter += row.fixed * row.fixed.transpose();
  const Vector3d lambda =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter / static_cast<double>(rows.size()))
          .eigenvalues();
  return {std::sqrt(std::max(0.0, lambda[1])), std::sqrt(std::max(0.0, lambda[2]))};
}

/// An offset tried to the end.
struct Solution {
  State state;
  std::vector<Row> rows;
  double residual_rad = 0;
};

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

constexpr double kDegree = 0.017453292519943295;

/// Why the best solution is none, empty if it is one.
std::string fault_of(const std::vector<Solution>& solutions, double window_s) {
  const Solution& best = solutions.front();
  const Eigen::Vector2d spread = axis_spread(best.rows);
  constexpr double kLeastTurn_rad = 0.2 * kDegree;
  if (spread[1] < kLeastTurn_rad) return "the bodies hardly turn: nothing to align by";
  if (best.residual_rad > 0.5 * spread[1])
    return "the rotations do not belong together: no offset makes them agree";
  if (spread[0] < std::max(kLeastTurn_rad / 2, best.residual_rad / 1.538))
    return "the bodies turn about one axis only: the rotation about it is unknown";
  for (const Solution& other : solutions)
    if (std::abs(other.state.offset_s - best.state.offset_s) > window_s / 2 &&
        other.residual_rad < 1.1 * best.residual_rad)
      return "two time offsets fit alike: the motion repeats itself";
  return {};
}

/// (R_a - 1) lever - scale R shift_b = -shift_a over all windows, reweighted.
estimation::Estimate<LeverAndScale> lever_of(const Pair& pair, const State& state) {
  using Answer = estimation::Estimate<LeverAndScale>;
  std::vector<Eigen::Matrix<double, 3, 4>> slopes;
  std::vector<Vector3d> targets;
  for (std::size_t i = 0; i < pair.windows.size(); ++i) {
    const auto moving = motion_over(pair.moving, shifted(pair.windows[i], state.offset_s));
    if (!moving) continue;
    Eigen::Matrix<double, 3, 4> slope;
    slope.leftCols<3>() =
        Matrix3d::Identity() - estimation::rotation_exp(moving->turn_rad).toRotationMatrix();
    slope.col(3) = state.rotation * pair.fixed_motions[i].shift_m;
    slopes.push_back(slope);
    targets.push_back(moving->shift_m);
  }
  Eigen::Vector4d x(0, 0, 0, 1);
  std::vector<double> lengths(slopes.size());
  Eigen::Matrix4d h;
  double sigma = 0;
  for (int round = 0; round < 10; ++round) {
    for (std::size_t i = 0; i < slopes.size(); ++i)
      lengths[i] = round == 0 ? 0 : (targets[i] - slopes[i] * x).norm();
    sigma = std::max(median(lengths) / 1.538, 1e-9);
    h.setZero();
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const double weight = 1 / (1 + std::pow(lengths[i] / (4 * sigma), 2));
      h += weight * slopes[i].transpose() * slopes[i];
      g += weight * slopes[i].transpose() * targets[i];
    }
    x = h.ldlt().solve(g);
  }
  double reach_m = 0;
  for (const Vector3d& t : targets) reach_m = std::max(reach_m, t.norm());
  // Overlapping windows share samples: count one window once.
  const double overlap =
      std::max(1.0, (pair.windows[0].to_s - pair.windows[0].from_s) / pair.fixed.median_step_s());
  const auto judged = estimation::judge(h / (sigma * sigma * overlap),
                                        Eigen::Vector4d(reach_m, reach_m, reach_m, 1));
  if (judged.verdict.standing == estimation::Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Answer answer;
  answer.value = {x.head<3>(), x[3]};
  answer.covariance = judged.covariance;
  answer.residuals = Eigen::Map<const Eigen::VectorXd>(lengths.data(), std::ssize(lengths));
  answer.verdict = judged.verdict;
  return answer;
}

estimation::Verdict verdict_of(const Eigen::Matrix4d& covariance, double rotation_sigma_rad) {
  const double time_sigma_s = std::sqrt(covariance(0, 0));
  constexpr double kWeakTime_s = 0.005, kWeakRotation_rad = kDegree;
  if (time_sigma_s > kWeakTime_s)
    return estimation::Verdict::weak(Eigen::Vector4d::UnitX(), time_sigma_s,
                                     "the time offset is uncertain");
  if (rotation_sigma_rad > kWeakRotation_rad) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance.bottomRightCorner<3, 3>());
    Eigen::Vector4d direction = Eigen::Vector4d::Zero();
    direction.tail<3>() = solver.eigenvectors().col(2);
    return estimation::Verdict::weak(direction, rotation_sigma_rad,
                                     "the rotation about one axis is uncertain");
  }
  return estimation::Verdict::ok();
}

/// The estimate for (moving, fixed), before the roles are swapped back.
Estimate align_pair(const Pair& pair, const AlignOptions& options) {
  if (pair.windows.empty()) return Estimate::degenerate("a trajectory is shorter than one window");
  constexpr int kCandidates = 5;
  const auto candidates = offset_candidates(pair.moving, pair.fixed, options, kCandidates);
  if (candidates.empty())
    return Estimate::degenerate("the trajectories share too little time, or do not move alike");
  const auto solutions = solutions_of(pair, candidates);
  if (solutions.empty())
    return Estimate::degenerate("too few common relative motions: gaps, or too short a recording");
  if (auto fault = fault_of(solutions, options.window_s); !fault.empty())
    return Estimate::degenerate(fault);
  const Solution& best = solutions.front();
  Estimate estimate;
  const Eigen::Matrix4d covariance = covariance_of(best.rows, options.window_s);
  if (!covariance.allFinite()) return Estimate::degenerate("the motion carries no alignment");
  estimate.covariance = covariance;
  Alignment& value = estimate.value;
  value.time_offset_s = best.state.offset_s;
  value.time_offset_sigma_s = std::sqrt(covariance(0, 0));
  value.a_from_b = best.state.rotation;
  value.rotation_sigma_rad =
      std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance.bottomRightCorner<3, 3>())
                    .eigenvalues()[2]);
  value.median_residual_rad = best.residual_rad;
  estimate.residuals.resize(std::ssize(best.rows));
  for (std::size_t i = 0; i < best.rows.size(); ++i) {
    const double angle_rad = best.rows[i].residual.norm();
    value.residuals.push_back({best.rows[i].t_s + best.state.offset_s, angle_rad});
    estimate.residuals[static_cast<Eigen::Index>(i)] = angle_rad;
    if (best.rows[i].weight > 0.5) estimate.inliers.push_back(static_cast<int>(i));
  }
  value.lever_and_scale = lever_of(pair, best.state);
  estimate.verdict = verdict_of(covariance, value.rotation_sigma_rad);
  return estimate;
}

/// From (B as moving, A as fixed) to A from B.
void swap_roles(Estimate& e) {
  Alignment& v = e.value;
  for (AlignResidual& r : v.residuals) r.t_s -= v.time_offset_s;
  v.time_offset_s = -v.time_offset_s;
  v.a_from_b = v.a_from_b.conjugate();
  Eigen::Matrix4d map = Eigen::Matrix4d::Zero();
  map(0, 0) = -1;
  map.bottomRightCorner<3, 3>() = -v.a_from_b.toRotationMatrix();
  e.covariance = map * e.covariance * map.transpose();
  auto& lever = v.lever_and_scale;
  if (!lever.usable()) return;
  const double scale = 1 / lever.value.scale;
  const Vector3d back = -scale * (v.a_from_b * lever.value.lever_m);
  Eigen::Matrix4d lever_map = Eigen::Matrix4d::Zero();
  lever_map.topLeftCorner<3, 3>() = -scale * v.a_from_b.toRotationMatrix();
  lever_map.topRightCorner<3, 1>() = -scale * back;
  lever_map(3, 3) = -scale * scale;
  lever.covariance = lever_map * lever.covariance * lever_map.transpose();
  lever.value = {back, scale};
}

}  // namespace

Estimate align(const Trajectory& a, const Trajectory& b, const AlignOptions& options) {
  if (a.samples().size() < 4 || b.samples().size() < 4)
    return Estimate::degenerate("a trajectory has fewer than 4 usable poses");
  // The sparser one keeps its samples, the denser one is interpolated.
  if (a.median_step_s() <= b.median_step_s())
    return align_pair(make_pair(a, b, options.window_s), options);
  Estimate estimate = align_pair(make_pair(b, a, options.window_s), options);
  if (estimate.usable()) swap_roles(estimate);
  return estimate;
}

}  // namespace mixrig::sync
