// SPDX-License-Identifier: Apache-2.0
#include "host/pose/trajectory/align.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "host/math/estimation/decompositions.h"
#include "host/pose/trajectory/align_shifts.h"

namespace mixrig::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Estimate = estimation::Estimate<Alignment>;

constexpr double kDegree = 0.017453292519943295;

/// Root mean square turns of the fixed body about its principal axes, smallest first.
struct AxisSpread {
  Vector3d turn_rad;
  Matrix3d axes;
};

AxisSpread axis_spread(const std::vector<Row>& rows) {
  Matrix3d scatter = Matrix3d::Zero();
  for (const Row& row : rows) scatter += row.fixed * row.fixed.transpose();
  const auto spectrum = estimation::spectrum_of(scatter / static_cast<double>(rows.size()));
  return {spectrum.values.cwiseMax(0).cwiseSqrt(), spectrum.axes};
}

constexpr double kLeastTurn_rad = 0.2 * kDegree;

/// Whether the bodies turn about one axis only, so that the rotation about it is not observable.
bool has_one_axis(const Solution& best) {
  return axis_spread(best.rows).turn_rad[1] <
         std::max(kLeastTurn_rad / 2, coordinate_sigma(best.residual_rad));
}

/// Why the best solution is not accepted, empty if it is.
std::string fault_of(const std::vector<Solution>& solutions, double window_s) {
  const Solution& best = solutions.front();
  const double turn_rad = axis_spread(best.rows).turn_rad[2];
  if (turn_rad < kLeastTurn_rad) return "the bodies hardly turn: nothing to align by";
  if (best.residual_rad > 0.5 * turn_rad)
    return "the rotations do not match: no offset makes them agree";
  for (const Solution& other : solutions)
    if (std::abs(other.state.offset_s - best.state.offset_s) > window_s / 2 &&
        other.residual_rad < 1.1 * best.residual_rad)
      return "two time offsets fit equally well: the motion repeats itself";
  return {};
}

estimation::Verdict verdict_of(const Eigen::Matrix4d& covariance, double rotation_sigma_rad) {
  const double time_sigma_s = std::sqrt(covariance(0, 0));
  constexpr double kWeakTime_s = 0.005, kWeakRotation_rad = kDegree;
  if (time_sigma_s > kWeakTime_s)
    return estimation::Verdict::weak(Eigen::Vector4d::UnitX(), time_sigma_s,
                                     "the time offset is uncertain");
  if (rotation_sigma_rad > kWeakRotation_rad) {
    Eigen::Vector4d direction = Eigen::Vector4d::Zero();
    direction.tail<3>() = estimation::spectrum_of(covariance.bottomRightCorner<3, 3>()).axes.col(2);
    return estimation::Verdict::weak(direction, rotation_sigma_rad,
                                     "the rotation about one axis is uncertain");
  }
  return estimation::Verdict::ok();
}

/// Solution, covariance of (offset, rotation), lever and scale.
struct Answer {
  Solution best;
  Eigen::Matrix4d covariance;
  estimation::Estimate<LeverAndScale> lever;
};

/// Aligns by the turns alone, which determine offset and rotation. Positions are left out: their
/// drift would bias both.
Answer answer_from_turns(const Pair& pair, const Solution& best, double window_s) {
  return {best, covariance_of(best.rows, window_s), lever_of(pair, best.state)};
}

/// Aligns bodies with one axis of rotation: the epipoles must determine the rotation about it.
std::optional<Answer> answer_with_epipoles(const Pair& pair, const Solution& best) {
  const Vector3d axis = axis_spread(best.rows).axes.col(2);
  const auto start = turned_by_epipoles(pair, best.state, axis);
  if (!start) return std::nullopt;
  const auto joint = refine_jointly(pair, *start);
  if (!joint) return std::nullopt;
  Answer answer{{joint->at.state, weighted_rows(pair, joint->at.state), 0},
                joint->covariance.topLeftCorner<4, 4>(),
                estimation::Estimate<LeverAndScale>::degenerate(
                    "the bodies turn about one axis only: the lever arm along it is unknown")};
  answer.best.residual_rad = median_residual(answer.best.rows);
  return answer;
}

Estimate estimate_of(const Answer& answer) {
  const Solution& best = answer.best;
  if (!answer.covariance.allFinite())
    return Estimate::degenerate("the motion does not determine an alignment");
  Estimate estimate;
  estimate.covariance = answer.covariance;
  Alignment& value = estimate.value;
  value.time_offset_s = best.state.offset_s;
  value.time_offset_sigma_s = std::sqrt(answer.covariance(0, 0));
  value.a_from_b = best.state.rotation;
  value.rotation_sigma_rad =
      std::sqrt(estimation::spectrum_of(answer.covariance.bottomRightCorner<3, 3>()).values[2]);
  value.median_residual_rad = best.residual_rad;
  estimate.residuals.resize(std::ssize(best.rows));
  for (std::size_t i = 0; i < best.rows.size(); ++i) {
    const double angle_rad = best.rows[i].residual.norm();
    value.residuals.push_back({best.rows[i].t_s + best.state.offset_s, angle_rad});
    estimate.residuals[static_cast<Eigen::Index>(i)] = angle_rad;
    if (best.rows[i].weight > 0.5) estimate.inliers.push_back(static_cast<int>(i));
  }
  value.lever_and_scale = answer.lever;
  estimate.verdict = verdict_of(answer.covariance, value.rotation_sigma_rad);
  return estimate;
}

/// Returns the estimate for (moving, fixed), before the roles are swapped back.
Estimate align_pair(const Pair& pair, const AlignOptions& options) {
  if (pair.windows.empty())
    return Estimate::degenerate("a trajectory is shorter than one window of " +
                                std::to_string(std::lround(1e3 * options.window_s)) +
                                " ms: give longer ones, or a shorter window");
  constexpr int kCandidates = 5;
  const auto candidates = offset_candidates(pair.moving, pair.fixed, options, kCandidates);
  if (candidates.empty())
    return Estimate::degenerate("the trajectories share too little time, or do not move alike");
  const auto solutions = solutions_of(pair, candidates);
  if (solutions.empty())
    return Estimate::degenerate("too few common relative motions: gaps, or too short a recording");
  if (auto fault = fault_of(solutions, options.window_s); !fault.empty())
    return Estimate::degenerate(fault);
  if (!has_one_axis(solutions.front()))
    return estimate_of(answer_from_turns(pair, solutions.front(), options.window_s));
  const auto answer = answer_with_epipoles(pair, solutions.front());
  if (!answer)
    return Estimate::degenerate(
        "the bodies turn about one axis only, and their paths do not determine the rotation about "
        "it");
  return estimate_of(*answer);
}

/// Swaps the roles back: from (B moving, A fixed) to A from B.
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

}  // namespace mixrig::trajectory
