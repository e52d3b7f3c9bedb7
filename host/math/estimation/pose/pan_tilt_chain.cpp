// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/pose/pan_tilt_chain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <Eigen/Core>

#include "host/math/estimation/consensus.h"
#include "host/math/estimation/pose/hand_eye.h"
#include "host/math/estimation/pose/pose_residual.h"
#include "host/math/estimation/small_solve.h"
#include "host/math/geometry/linear.h"

namespace mixrig::estimation {
namespace {

using detail::PoseT;
using Eigen::Vector3d;
using geometry::Pose;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using ChainViews = std::span<const PanTiltView>;

constexpr int kParameters = 16;

template <typename T>
Eigen::Quaternion<T> turn_about(const Eigen::Matrix<T, 3, 1>& axis, const T& angle) {
  using std::cos, std::sin;
  const Eigen::Matrix<T, 3, 1> v = sin(angle / 2.0) * axis;
  return {cos(angle / 2.0), v.x(), v.y(), v.z()};
}

template <typename T>
PoseT<T> head_pose(const T& skew_rad, const T& offset_m, const T& pan_rad, const T& tilt_rad) {
  using std::cos, std::sin;
  using Vector3T = Eigen::Matrix<T, 3, 1>;
  const Vector3T tilt_axis(cos(skew_rad), T(0), sin(skew_rad));
  const auto pan = turn_about<T>(Vector3T(T(0), T(0), T(1)), pan_rad);
  return {pan * turn_about<T>(tilt_axis, tilt_rad), pan * Vector3T(T(0), offset_m, T(0))};
}

/// A view with the inverse root of its noise.
struct WhiteView {
  PanTiltView view;
  Matrix6d whitener;
};

/// Whitened error of the predicted camera_from_target: rotation, then translation.
template <typename T>
Eigen::Matrix<T, 6, 1> view_error(const PoseT<T>& base_from_camera,
                                  const PoseT<T>& base_from_target, const WhiteView& white) {
  return white.whitener.cast<T>() *
         detail::chain_error<T>(base_from_camera, base_from_target, white.view.camera_from_target);
}

/// Parameters in the order of the covariance, lengths in units of `scale_m`.
struct ChainResiduals {
  std::span<const WhiteView> views;
  std::span<const int> indices;
  PanTiltCalibration start;
  double scale_m;

  int NumResiduals() const { return 6 * static_cast<int>(indices.size()); }
  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    const PanTiltChain& c = start.chain;
    const T skew_rad = x[0] + c.skew_rad, offset_m = x[1] * scale_m + c.offset_m;
    const T pan_scale = x[2] + c.pan_scale, tilt_scale = x[3] + c.tilt_scale;
    const PoseT<T> head_from_camera = detail::perturbed(c.head_from_camera, x + 4, scale_m);
    const PoseT<T> base_from_target = detail::perturbed(start.base_from_target, x + 10, scale_m);
    Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, 1>> out(residuals, NumResiduals());
    for (std::size_t k = 0; k < indices.size(); ++k) {
      const WhiteView& white = views[indices[k]];
      const PoseT<T> head = head_pose<T>(skew_rad, offset_m, pan_scale * white.view.pan_rad,
                                         tilt_scale * white.view.tilt_rad);
      out.template segment<6>(6 * static_cast<Eigen::Index>(k)) =
          view_error<T>(head * head_from_camera, base_from_target, white);
    }
    return true;
  }
};

PanTiltCalibration moved(const PanTiltCalibration& c,
                         const Eigen::Matrix<double, kParameters, 1>& x, double scale_m) {
  return {{c.chain.skew_rad + x[0], c.chain.offset_m + scale_m * x[1], c.chain.pan_scale + x[2],
           c.chain.tilt_scale + x[3],
           detail::moved(c.chain.head_from_camera, x.segment<6>(4), scale_m)},
          detail::moved(c.base_from_target, x.segment<6>(10), scale_m)};
}

struct Fit {
  PanTiltCalibration value;
  Eigen::MatrixXd information;  // in metres
};

/// A target seen by one camera: the hand-eye problem of ideal axes, with generous noise.
Estimate<HandEye> ideal_chain(ChainViews views, double scale_m) {
  std::vector<Pose> hands, eyes;
  for (const PanTiltView& view : views) {
    hands.push_back(base_from_head({}, view.pan_rad, view.tilt_rad));
    eyes.push_back(view.camera_from_target);
  }
  Estimate<HandEye> fit;
  // Skew and encoder scales act like noise that grows with the angles of the unit; with small
  // angles less noise must be assumed, or the rotation would not be significant.
  for (const double sigma_rad : {0.05, 0.02, 0.005}) {
    fit = solve_hand_eye(hands, eyes, {sigma_rad, 2 * sigma_rad * scale_m});
    if (fit.usable()) break;
  }
  return fit;
}

std::optional<Fit> solve(std::span<const WhiteView> views, std::span<const int> indices,
                         PanTiltCalibration start, double scale_m) {
  Eigen::MatrixXd information;
  // The second pass starts at the minimum, so its Jacobian is that of pose_error().
  for (int pass = 0; pass < 2; ++pass) {
    const auto solution =
        detail::minimise<kParameters>(ChainResiduals{views, indices, start, scale_m});
    if (!solution.finite()) return std::nullopt;
    start = moved(start, solution.x, scale_m);
    information = solution.information();
  }
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(kParameters);
  for (int k : {1, 7, 8, 9, 13, 14, 15}) unit[k] = 1 / scale_m;
  return Fit{start, unit.asDiagonal() * information * unit.asDiagonal()};
}

std::string input_fault(ChainViews views, double angle_sigma_rad) {
  if (views.size() < 4) return "fewer than 4 views";
  if (!(angle_sigma_rad >= 0)) return "the repeatability must not be negative";
  double pan[2] = {INFINITY, -INFINITY}, tilt[2] = {INFINITY, -INFINITY};
  for (std::size_t i = 0; i < views.size(); ++i) {
    const PanTiltView& v = views[i];
    if (!std::isfinite(v.pan_rad) || !std::isfinite(v.tilt_rad) ||
        !v.camera_from_target.translation_m.allFinite() ||
        !(std::abs(v.camera_from_target.rotation.norm() - 1) < 1e-6) || !v.covariance.allFinite() ||
        !geometry::Cholesky6(v.covariance).is_positive())
      return "view " + std::to_string(i) + " is not finite, or its covariance is not positive";
    pan[0] = std::min(pan[0], v.pan_rad), pan[1] = std::max(pan[1], v.pan_rad);
    tilt[0] = std::min(tilt[0], v.tilt_rad), tilt[1] = std::max(tilt[1], v.tilt_rad);
  }
  constexpr double kLeastTurn_rad = 0.02;
  if (pan[1] - pan[0] < kLeastTurn_rad) return "the pan axis did not turn";
  if (tilt[1] - tilt[0] < kLeastTurn_rad) return "the tilt axis did not turn";
  return {};
}

/// How a small turn of each axis moves camera_from_target, in its error parameters.
Eigen::Matrix<double, 6, 2> angle_slope(const PanTiltView& view, const Pose& head_from_camera) {
  const Pose camera_from_head = geometry::inverse(head_from_camera);
  const Pose camera_from_base =
      camera_from_head * geometry::inverse(base_from_head({}, view.pan_rad, view.tilt_rad));
  const std::array<Vector3d, 2> axes = {camera_from_base.rotation * Vector3d::UnitZ(),
                                        camera_from_head.rotation * Vector3d::UnitX()};
  const std::array<Vector3d, 2> feet = {camera_from_base.translation_m,
                                        camera_from_head.translation_m};
  Eigen::Matrix<double, 6, 2> slope;
  for (int k = 0; k < 2; ++k)
    slope.col(k) << -axes[k],
        -axes[k].cross(Vector3d(view.camera_from_target.translation_m - feet[k]));
  return slope;
}

std::vector<WhiteView> whitened(ChainViews views, const Pose& head_from_camera,
                                double angle_sigma_rad) {
  std::vector<WhiteView> white;
  for (const PanTiltView& view : views) {
    const auto slope = angle_slope(view, head_from_camera);
    const Matrix6d noise =
        view.covariance + angle_sigma_rad * angle_sigma_rad * slope * slope.transpose();
    const Matrix6d root = geometry::Cholesky6(noise).root();
    white.push_back(
        {view, root.triangularView<Eigen::Lower>().solve(Matrix6d(Matrix6d::Identity()))});
  }
  return white;
}

double squared_error(const PanTiltCalibration& c, const WhiteView& white) {
  const Pose at = base_from_camera(c.chain, white.view.pan_rad, white.view.tilt_rad);
  return view_error<double>(detail::pose_cast<double>(at),
                            detail::pose_cast<double>(c.base_from_target), white)
      .squaredNorm();
}

Eigen::VectorXd extent_of(double scale_m) {
  Eigen::VectorXd extent = Eigen::VectorXd::Ones(kParameters);
  for (int k : {1, 7, 8, 9, 13, 14, 15}) extent[k] = scale_m;
  return extent;
}

}  // namespace

Pose base_from_head(const PanTiltChain& chain, double pan_rad, double tilt_rad) {
  const auto head = head_pose<double>(chain.skew_rad, chain.offset_m, chain.pan_scale * pan_rad,
                                      chain.tilt_scale * tilt_rad);
  return {head.rotation, head.translation};
}

Pose base_from_camera(const PanTiltChain& chain, double pan_rad, double tilt_rad) {
  return base_from_head(chain, pan_rad, tilt_rad) * chain.head_from_camera;
}

Estimate<PanTiltCalibration> calibrate_pan_tilt(ChainViews views, double angle_sigma_rad) {
  using Answer = Estimate<PanTiltCalibration>;
  if (auto fault = input_fault(views, angle_sigma_rad); !fault.empty())
    return Answer::degenerate(fault);
  const int n = static_cast<int>(views.size());
  std::vector<int> everything(n);
  std::iota(everything.begin(), everything.end(), 0);
  double scale_m = 0;
  for (const PanTiltView& v : views)
    scale_m = std::max(scale_m, v.camera_from_target.translation_m.norm());
  if (!(scale_m > 0)) return Answer::degenerate("the target lies in the camera's centre");

  const auto ideal = ideal_chain(views, scale_m);
  if (!ideal.usable())
    return Answer::degenerate("the views do not fit a camera on a pan-tilt unit: " +
                              ideal.verdict.reason);
  PanTiltCalibration start;
  start.chain.head_from_camera = ideal.value.hand_from_eye;
  start.base_from_target = ideal.value.world_from_target;
  const auto white = whitened(views, start.chain.head_from_camera, angle_sigma_rad);
  const auto fit = [&](std::span<const int> indices) {
    return solve(white, indices, start, scale_m);
  };
  const auto sample = [&](std::span<const int> indices) {
    const auto one = fit(indices);
    return one ? std::vector<Fit>{*one} : std::vector<Fit>{};
  };
  const auto cost = [&](const Fit& f, int i) { return squared_error(f.value, white[i]); };
  auto found = fit_with_consensus<Fit>({n, 4, 6, kParameters}, true, fit, sample, cost);
  if (!found.model) return Answer::degenerate(found.reason);
  const auto judged = judge(found.model->information, extent_of(scale_m));
  if (judged.verdict.standing == Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Eigen::VectorXd residuals(n);
  for (int i = 0; i < n; ++i) residuals[i] = std::sqrt(cost(*found.model, i));
  return {found.model->value, judged.covariance, std::move(residuals), std::move(found.inliers),
          judged.verdict};
}

}  // namespace mixrig::estimation
