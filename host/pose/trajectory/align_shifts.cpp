// SPDX-License-Identifier: Apache-2.0
#include "host/pose/trajectory/align_shifts.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "hal/base/order_statistics.h"
#include "host/pose/trajectory/observable_inverse.h"

namespace mixrig::trajectory {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using estimation::skew;
using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

Matrix3d turn_of(const Motion& motion) {
  return estimation::rotation_exp(motion.turn_rad).toRotationMatrix();
}

/// Sandwich covariance with Bartlett weights over twice the window: `scores` are the gradients of
/// the windows at `times_s`, in order of time, `inverse` that of their Hessian.
template <int kSize>
Eigen::Matrix<double, kSize, kSize> sandwich(
    const std::vector<Eigen::Matrix<double, kSize, 1>>& scores, const std::vector<double>& times_s,
    const Eigen::Matrix<double, kSize, kSize>& inverse, double window_s) {
  Eigen::Matrix<double, kSize, kSize> s = Eigen::Matrix<double, kSize, kSize>::Zero();
  const double reach_s = 2 * window_s;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    s += scores[i] * scores[i].transpose();
    for (std::size_t j = i + 1; j < scores.size() && times_s[j] - times_s[i] < reach_s; ++j) {
      const double share = 1 - (times_s[j] - times_s[i]) / reach_s;
      s += share * (scores[i] * scores[j].transpose() + scores[j] * scores[i].transpose());
    }
  }
  return inverse * s * inverse;
}

/// One window of both kinds: residual and slopes against (offset, rotation, lever, scale).
struct JointRow {
  double t_s;
  Vector3d turn, shift;
  Eigen::Matrix<double, 3, 8> turn_slope, shift_slope;
};

std::vector<JointRow> joint_rows(const Pair& pair, const JointStart& at_start) {
  const State& state = at_start.state;
  const LeverAndScale& l = at_start.lever;
  const Matrix3d observable =
      Matrix3d::Identity() - at_start.unobservable * at_start.unobservable.transpose();
  std::vector<JointRow> rows;
  const double probe_s = 0.25 * pair.moving.median_step_s();
  const auto bare = [&](const Motion& m) -> Vector3d {
    return m.shift_m - l.lever_m + turn_of(m) * l.lever_m;
  };
  for (std::size_t i = 0; i < pair.windows.size(); ++i) {
    const auto moving = probed(pair.moving, shifted(pair.windows[i], state.offset_s), probe_s);
    if (!moving) continue;
    const Vector3d turn = state.rotation * pair.fixed_motions[i].turn_rad;
    const Vector3d shift = state.rotation * pair.fixed_motions[i].shift_m;
    JointRow row{pair.windows[i].from_s, moving->at.turn_rad - turn,
                 bare(moving->at) - l.scale * shift, Eigen::Matrix<double, 3, 8>::Zero(),
                 Eigen::Matrix<double, 3, 8>::Zero()};
    row.turn_slope.col(0) = (moving->after.turn_rad - moving->before.turn_rad) / (2 * probe_s);
    row.turn_slope.middleCols<3>(1) = skew(turn);
    row.shift_slope.col(0) = (bare(moving->after) - bare(moving->before)) / (2 * probe_s);
    row.shift_slope.middleCols<3>(1) = l.scale * skew(shift);
    row.shift_slope.middleCols<3>(4) = (turn_of(moving->at) - Matrix3d::Identity()) * observable;
    row.shift_slope.col(7) = -shift;
    rows.push_back(row);
  }
  return rows;
}

/// Normal equations, and the gradients of the single windows.
struct Normal {
  Matrix8d hessian = Matrix8d::Zero();
  Vector8d gradient = Vector8d::Zero();
  std::vector<Vector8d> scores;
  std::vector<double> times_s;
};

Normal normal_of(const std::vector<JointRow>& rows) {
  std::vector<double> turns, shifts;
  for (const JointRow& row : rows) {
    turns.push_back(row.turn.norm());
    shifts.push_back(row.shift.norm());
  }
  const double turn_sigma = coordinate_sigma(upper_median(turns));
  const double shift_sigma = coordinate_sigma(upper_median(shifts));
  Normal n;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const JointRow& row = rows[i];
    const double turn = cauchy_weight(turns[i], turn_sigma) / (turn_sigma * turn_sigma);
    const double shift = cauchy_weight(shifts[i], shift_sigma) / (shift_sigma * shift_sigma);
    n.hessian += turn * row.turn_slope.transpose() * row.turn_slope +
                 shift * row.shift_slope.transpose() * row.shift_slope;
    n.scores.push_back(turn * row.turn_slope.transpose() * row.turn +
                       shift * row.shift_slope.transpose() * row.shift);
    n.gradient += n.scores.back();
    n.times_s.push_back(row.t_s);
  }
  return n;
}

/// Solves target = slope * x over all windows by iteratively reweighted least squares.
template <int kSize>
struct ShiftFit {
  std::vector<Eigen::Matrix<double, 3, kSize>> slopes;
  std::vector<Vector3d> targets;
  Eigen::Matrix<double, kSize, 1> x = Eigen::Matrix<double, kSize, 1>::Zero();
  Eigen::Matrix<double, kSize, kSize> hessian, inverse;  // for unit weight
  std::vector<double> lengths;                           // of the residuals
  double sigma = 0;                                      // of one coordinate

  void solve(int lever) {
    lengths.assign(slopes.size(), 0.0);
    for (int round = 0; round < 10; ++round) {
      hessian.setZero();
      Eigen::Matrix<double, kSize, 1> g = Eigen::Matrix<double, kSize, 1>::Zero();
      for (std::size_t i = 0; i < slopes.size(); ++i) {
        const double weight = round == 0 ? 1 : cauchy_weight(lengths[i], sigma);
        hessian += weight * slopes[i].transpose() * slopes[i];
        g += weight * slopes[i].transpose() * targets[i];
      }
      inverse = observable_inverse(hessian, lever);
      x = inverse * g;
      for (std::size_t i = 0; i < slopes.size(); ++i)
        lengths[i] = (targets[i] - slopes[i] * x).norm();
      sigma = coordinate_sigma(upper_median(lengths));
    }
  }
};

/// Returns how many overlapping windows count as one, since they share samples.
double overlap_of(const Pair& pair) {
  const double window_s = pair.windows[0].to_s - pair.windows[0].from_s;
  return std::max(1.0, window_s / pair.fixed.median_step_s());
}

constexpr std::size_t kFewestRows = 30;

}  // namespace

estimation::Estimate<LeverAndScale> lever_of(const Pair& pair, const State& state) {
  using Answer = estimation::Estimate<LeverAndScale>;
  ShiftFit<4> fit;
  for (std::size_t i = 0; i < pair.windows.size(); ++i) {
    const auto moving = motion_over(pair.moving, shifted(pair.windows[i], state.offset_s));
    if (!moving) continue;
    fit.slopes.emplace_back();
    fit.slopes.back() << Matrix3d::Identity() - turn_of(*moving),
        state.rotation * pair.fixed_motions[i].shift_m;
    fit.targets.push_back(moving->shift_m);
  }
  fit.solve(0);
  double reach_m = 0;
  for (const Vector3d& t : fit.targets) reach_m = std::max(reach_m, t.norm());
  const auto judged = estimation::judge(fit.hessian / (fit.sigma * fit.sigma * overlap_of(pair)),
                                        Eigen::Vector4d(reach_m, reach_m, reach_m, 1));
  if (judged.verdict.standing == estimation::Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Answer answer;
  answer.value = {fit.x.head<3>(), fit.x[3]};
  answer.covariance = judged.covariance;
  answer.residuals = Eigen::Map<const Eigen::VectorXd>(fit.lengths.data(), std::ssize(fit.lengths));
  answer.verdict = judged.verdict;
  return answer;
}

std::optional<JointStart> turned_by_epipoles(const Pair& pair, const State& state,
                                             const Vector3d& axis) {
  // With b = rotation * shift_fixed split along and across the axis, the turn by phi about it
  // makes the equations linear in (scale cos phi, scale sin phi, scale, lever).
  const Vector3d u = state.rotation * axis;
  const Matrix3d across = Matrix3d::Identity() - u * u.transpose();
  ShiftFit<6> fit;
  for (std::size_t i = 0; i < pair.windows.size(); ++i) {
    const auto moving = motion_over(pair.moving, shifted(pair.windows[i], state.offset_s));
    if (!moving) continue;
    const Vector3d b = state.rotation * pair.fixed_motions[i].shift_m;
    fit.slopes.emplace_back();
    fit.slopes.back() << across * b, u.cross(b), u.dot(b) * u,
        (Matrix3d::Identity() - turn_of(*moving)) * across;
    fit.targets.push_back(moving->shift_m);
  }
  if (fit.slopes.size() < kFewestRows) return std::nullopt;
  fit.solve(3);
  const double gain = std::hypot(fit.x[0], fit.x[1]);
  const double sigma_rad =
      fit.sigma * std::sqrt(overlap_of(pair) * fit.inverse.topLeftCorner<2, 2>().trace()) / gain;
  if (!(sigma_rad < kEpipoleSigma_rad)) return std::nullopt;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(std::atan2(fit.x[1], fit.x[0]), u));
  return JointStart{{state.offset_s, turn * state.rotation}, {fit.x.tail<3>(), gain}, u};
}

std::optional<JointFit> refine_jointly(const Pair& pair, const JointStart& start) {
  JointFit fit{start, Matrix8d::Zero()};
  State& state = fit.at.state;
  LeverAndScale& lever = fit.at.lever;
  constexpr int kMaxSteps = 30;
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto rows = joint_rows(pair, fit.at);
    if (rows.size() < kFewestRows) return std::nullopt;
    const Normal normal = normal_of(rows);
    const Matrix8d inverse = observable_inverse(normal.hessian, 4);
    const Vector8d delta = -inverse * normal.gradient;
    constexpr double kFarthest_s = 0.05;
    if (!delta.allFinite() || std::abs(state.offset_s - start.state.offset_s) > kFarthest_s)
      return std::nullopt;
    state.offset_s += delta[0];
    state.rotation = (estimation::rotation_exp(delta.segment<3>(1)) * state.rotation).normalized();
    lever.lever_m += delta.segment<3>(4);
    lever.scale += delta[7];
    if (std::abs(delta[0]) > 1e-7 || delta.segment<3>(1).norm() > 1e-7) continue;
    const double window_s = pair.windows[0].to_s - pair.windows[0].from_s;
    fit.covariance = sandwich<8>(normal.scores, normal.times_s, inverse, window_s);
    return fit;
  }
  return std::nullopt;
}

Eigen::Matrix4d covariance_of(const std::vector<Row>& rows, double window_s) {
  Eigen::Matrix4d h = Eigen::Matrix4d::Zero();
  std::vector<Eigen::Vector4d> scores;
  std::vector<double> times_s;
  for (const Row& row : rows) {
    h += row.weight * row.slope.transpose() * row.slope;
    scores.push_back(row.weight * row.slope.transpose() * row.residual);
    times_s.push_back(row.t_s);
  }
  const Eigen::Matrix4d inverse = h.inverse();
  return sandwich<4>(scores, times_s, inverse, window_s);
}

}  // namespace mixrig::trajectory
