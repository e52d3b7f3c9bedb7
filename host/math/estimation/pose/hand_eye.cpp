// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/hand_eye.h"

#include <cmath>

#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/linear_fit.h"
#include "host/math/estimation/pose/pose_residual.h"
#include "host/math/estimation/small_solve.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using geometry::Pose;
using Poses = std::span<const Pose>;

struct HandEyeFit {
  HandEye value;
  Eigen::Matrix<double, 12, 12> information;
};

/// Motions between two views: hand = X eye X^-1.
struct Motion {
  Pose hand, eye;
};

std::vector<Motion> motions_of(Poses hands, Poses eyes, std::span<const int> indices) {
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < indices.size(); ++i)
    for (std::size_t j = i + 1; j < indices.size(); ++j)
      motions.push_back({geometry::inverse(hands[indices[i]]) * hands[indices[j]],
                         eyes[indices[i]] * geometry::inverse(eyes[indices[j]])});
  return motions;
}

/// Axis times sine of half the angle: continuous through 180 degrees up to the sign.
Vector3d half_axis(const Eigen::Quaterniond& q) { return (q.w() < 0 ? -1.0 : 1.0) * q.vec(); }

/// Second largest spread of the motions' rotation axes over the largest, and that one.
Eigen::Vector2d axis_spread(const std::vector<Motion>& motions) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Motion& m : motions) {
    const Vector3d a = half_axis(m.hand.rotation);
    scatter += a * a.transpose();
  }
  const Vector3d lambda =
      spectrum_of(scatter / static_cast<double>(std::max<std::size_t>(1, motions.size()))).values;
  return {std::sqrt(std::max(0.0, lambda[1])), std::sqrt(std::max(0.0, lambda[2]))};
}

std::optional<HandEye> linear_start(Poses hands, Poses eyes, std::span<const int> indices) {
  const auto motions = motions_of(hands, eyes, indices);
  if (!(axis_spread(motions)[0] > 1e-7)) return std::nullopt;
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  constexpr double kNearHalfTurn = 0.1;  // |w| below this, noise may flip the axis
  for (const Motion& m : motions)
    if (std::abs(m.hand.rotation.w()) > kNearHalfTurn)
      cross += half_axis(m.hand.rotation) * half_axis(m.eye.rotation).transpose();
  HandEye start;
  start.hand_from_eye.rotation = fit_rotation(cross).rotation;
  Eigen::MatrixXd a(3 * motions.size(), 3);
  Eigen::VectorXd b(3 * motions.size());
  for (std::size_t k = 0; k < motions.size(); ++k) {
    a.middleRows<3>(3 * k) =
        motions[k].hand.rotation.toRotationMatrix() - Eigen::Matrix3d::Identity();
    b.segment<3>(3 * k) =
        start.hand_from_eye.rotation * motions[k].eye.translation_m - motions[k].hand.translation_m;
  }
  start.hand_from_eye.translation_m = solve_linear(a, b).x;
  start.world_from_target = hands[indices[0]] * start.hand_from_eye * eyes[indices[0]];
  return start;
}

/// Whitened error of one view in the axes of the eye: rotation, then translation.
template <typename T>
Eigen::Matrix<T, 6, 1> view_error(const detail::PoseT<T>& hand_from_eye,
                                  const detail::PoseT<T>& world_from_target, const Pose& hand,
                                  const Pose& eye, const HandEyeOptions& noise) {
  Eigen::Matrix<T, 6, 1> error =
      detail::chain_error<T>(detail::pose_cast<T>(hand) * hand_from_eye, world_from_target, eye);
  for (int k = 0; k < 3; ++k) {
    error[k] /= noise.sigma_rad;
    error[3 + k] /= noise.sigma_m;
  }
  return error;
}

struct HandEyeResiduals {
  Poses hands, eyes;
  std::span<const int> indices;
  HandEye start;
  HandEyeOptions noise;

  int NumResiduals() const { return 6 * static_cast<int>(indices.size()); }
  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    const auto hand_from_eye = detail::perturbed(start.hand_from_eye, x, 1);
    const auto world_from_target = detail::perturbed(start.world_from_target, x + 6, 1);
    Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, 1>> out(residuals, NumResiduals());
    for (std::size_t k = 0; k < indices.size(); ++k)
      out.template segment<6>(6 * static_cast<Eigen::Index>(k)) = view_error<T>(
          hand_from_eye, world_from_target, hands[indices[k]], eyes[indices[k]], noise);
    return true;
  }
};

std::optional<HandEyeFit> solve(Poses hands, Poses eyes, std::span<const int> indices,
                                const HandEyeOptions& noise) {
  auto start = linear_start(hands, eyes, indices);
  if (!start) return std::nullopt;
  HandEyeFit chain;
  // The second pass starts at the minimum, so its Jacobian is that of pose_error().
  for (int pass = 0; pass < 2; ++pass) {
    const auto solution =
        detail::minimise<12>(HandEyeResiduals{hands, eyes, indices, *start, noise});
    if (!solution.finite()) return std::nullopt;
    start->hand_from_eye = detail::moved(start->hand_from_eye, solution.x.head<6>(), 1);
    start->world_from_target = detail::moved(start->world_from_target, solution.x.tail<6>(), 1);
    chain = {*start, solution.information()};
  }
  return chain;
}

std::string input_fault(Poses hands, Poses eyes, const HandEyeOptions& noise) {
  if (hands.size() != eyes.size()) return "there must be one eye pose per hand pose";
  if (hands.size() < 3) return "fewer than 3 views";
  if (!(noise.sigma_m > 0) || !(noise.sigma_rad > 0)) return "the stated noise must be positive";
  for (std::size_t i = 0; i < hands.size(); ++i)
    for (const Pose& p : {hands[i], eyes[i]})
      if (!p.translation_m.allFinite() || !(std::abs(p.rotation.norm() - 1) < 1e-6))
        return "view " + std::to_string(i) +
               " is not finite, or its rotation is no unit quaternion";
  return {};
}

}  // namespace

Estimate<HandEye> solve_hand_eye(Poses world_from_hand, Poses eye_from_target,
                                 const HandEyeOptions& options) {
  using Answer = Estimate<HandEye>;
  if (auto fault = input_fault(world_from_hand, eye_from_target, options); !fault.empty())
    return Answer::degenerate(fault);
  const int n = static_cast<int>(world_from_hand.size());
  std::vector<int> everything(n);
  std::iota(everything.begin(), everything.end(), 0);
  const auto spread = axis_spread(motions_of(world_from_hand, eye_from_target, everything));
  if (spread[1] < 3 * options.sigma_rad) return Answer::degenerate("the hand did not rotate");
  if (spread[0] < 3 * options.sigma_rad)
    return Answer::degenerate("all rotations are about parallel axes: turn about a second axis");
  const auto fit = [&](std::span<const int> indices) {
    return solve(world_from_hand, eye_from_target, indices, options);
  };
  const auto sample = [&](std::span<const int> indices) {
    const auto start = linear_start(world_from_hand, eye_from_target, indices);
    return start ? std::vector<HandEyeFit>{{*start, {}}} : std::vector<HandEyeFit>{};
  };
  const auto cost = [&](const HandEyeFit& c, int i) {
    return view_error(detail::pose_cast<double>(c.value.hand_from_eye),
                      detail::pose_cast<double>(c.value.world_from_target), world_from_hand[i],
                      eye_from_target[i], options)
        .squaredNorm();
  };
  auto found = fit_with_consensus<HandEyeFit>({n, 3, 6, 12}, true, fit, sample, cost);
  if (!found.model) return Answer::degenerate(found.reason);
  double reach_m = 0;
  for (int i : found.inliers) reach_m = std::max(reach_m, eye_from_target[i].translation_m.norm());
  Eigen::VectorXd extent = Eigen::VectorXd::Constant(12, reach_m);
  extent.segment<3>(0).setOnes();
  extent.segment<3>(6).setOnes();
  const auto judged = judge(found.model->information, extent);
  if (judged.verdict.standing == Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Eigen::VectorXd residuals(n);
  for (int i = 0; i < n; ++i) residuals[i] = std::sqrt(cost(*found.model, i));
  return {found.model->value, judged.covariance, std::move(residuals), std::move(found.inliers),
          judged.verdict};
}

}  // namespace mixrig::estimation
