// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/patch_align.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "host/math/geometry/linear.h"
#include "host/pose/tracker/pose_covariance.h"

namespace mixrig::tracking {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kFloor_px = 0.1;     ///< error of a patch's position besides noise, per axis
constexpr double kFarthest_px = 2.5;  ///< largest offset that the gradients can measure
constexpr float kLeastNoise = 1.5F;   ///< smallest noise of a grey value, of 255
constexpr double kTukey = 4.685;
constexpr double kStill_px = 0.01;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond turn_by(const Vector3d& w) {
  const double angle = w.norm();
  return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, w / angle))
                   : Eigen::Quaterniond::Identity();
}

float bilinear(const Image<float>& image, float x, float y) {
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const float u = x - static_cast<float>(left), v = y - static_cast<float>(top);
  const float *a = image.row(top) + left, *b = image.row(top + 1) + left;
  const float upper = a[0] + u * (a[1] - a[0]), lower = b[0] + u * (b[1] - b[0]);
  return upper + v * (lower - upper);
}

}  // namespace

double PatchFit::sigma_m() const { return std::sqrt(covariance.diagonal().tail<3>().sum()); }
double PatchFit::sigma_rad() const { return std::sqrt(covariance.diagonal().head<3>().sum()); }

PatchAlign::PatchAlign(const PatchMap& map, const geometry::AnyCamera& camera,
                       const AlignOptions& options)
    : map_(map),
      camera_(camera),
      options_(options),
      parameters_(geometry::parameters_of(camera)),
      coarsest_(std::max(options.finest, static_cast<int>(std::log2(std::max(
                                             1.0, options.coarsest_rad * parameters_[0]))))),
      choice_(map, camera, options.patches) {
  seen_.reserve(static_cast<std::size_t>(options.patches));
  distances_.reserve(static_cast<std::size_t>(options.patches));
}

void PatchAlign::look(const GreyPyramid& picture, const geometry::Pose& pose, int k, Seen& s) {
  const Patch& p = *s.patch;
  s.in_picture = false;
  const Vector3d centre = pose * p.centre_m.cast<double>();
  const auto projection =
      geometry::project_with_jacobians(geometry::kind_of(camera_), parameters_.data(), centre);
  if (!projection) return;
  s.px = projection->px;
  const Image<float>& image = picture.level(k);
  const double to_level = 1.0 / (1 << k);
  const Eigen::Matrix<double, 2, 3> by_point = to_level * projection->d_point;
  const Eigen::Matrix<float, 2, 3> by_room =
      (by_point * pose.rotation.toRotationMatrix()).cast<float>();
  const auto cx = static_cast<float>(down(s.px.x(), k)), cy = static_cast<float>(down(s.px.y(), k));
  std::array<float, kPatchPixels> values{};
  float mean = 0;
  const float most_x = static_cast<float>(image.width()) - 1.001F;
  const float most_y = static_cast<float>(image.height()) - 1.001F;
  for (std::size_t i = 0; i < kPatchPixels; ++i) {
    const float x =
        cx + by_room(0, 0) * p.x_m[i] + by_room(0, 1) * p.y_m[i] + by_room(0, 2) * p.z_m[i];
    const float y =
        cy + by_room(1, 0) * p.x_m[i] + by_room(1, 1) * p.y_m[i] + by_room(1, 2) * p.z_m[i];
    if (!(x >= 0 && y >= 0 && x < most_x && y < most_y)) return;
    values[i] = p.share[i] * bilinear(image, x, y);
    mean += values[i];
  }
  mean /= p.known;
  float energy = 0, product = 0;
  for (std::size_t i = 0; i < kPatchPixels; ++i) {
    values[i] = p.share[i] * (values[i] - mean);
    energy += values[i] * values[i];
    product += values[i] * p.grey[i];
  }
  s.in_picture = true;
  s.correlation = energy > 0 ? product / std::sqrt(energy * p.energy) : 0;
  // The contrast follows from a regression, so that noise does not count as contrast.
  const float share = std::max(s.correlation, 0.4F);
  const float contrast = std::clamp(share * std::sqrt(energy / p.energy), 0.02F, 5.0F);
  double by_u = 0, by_v = 0, squares = 0;
  for (std::size_t i = 0; i < kPatchPixels; ++i) {
    const float r = values[i] / contrast - p.grey[i];
    by_u += p.grey_u[i] * r, by_v += p.grey_v[i] * r;
    squares += r * r;
  }
  Matrix2d h;
  h << p.uu, p.uv, p.uv, p.vv;
  // A direction without gradients is not determined: its offset is 0, its information small.
  h.diagonal().array() += 1e-3 * (p.uu + p.vv) + 1e-6;
  const Matrix2d inverse = h.inverse();
  s.offset = inverse * Vector2d(by_u, by_v);
  const double least = kLeastNoise / contrast;
  const double variance = std::max(squares / (p.known - 3), least * least);
  s.information = (variance * inverse + kFloor_px * kFloor_px * Matrix2d::Identity()).inverse();
  Eigen::Matrix<float, 3, 2> along;
  along << p.u_m, p.v_m;
  const Matrix2d picture_by_patch = (by_room * along).cast<double>();
  if (std::abs(picture_by_patch.determinant()) < 1e-3) {
    s.in_picture = false;
    return;
  }
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << -cross_matrix(centre), Matrix3d::Identity();
  s.jacobian = picture_by_patch.inverse() * by_point * by_pose;
}

/// Sets the weights; returns the scale of the distances in sigmas, at least 1.
double PatchAlign::weigh(double least_correlation) {
  distances_.clear();
  for (Seen& s : seen_) {
    const bool counts = s.in_picture && s.correlation >= least_correlation &&
                        s.offset.cwiseAbs().maxCoeff() <= kFarthest_px;
    s.weight = counts ? std::sqrt(s.offset.dot(s.information * s.offset)) : -1;
    if (counts) distances_.push_back(s.weight);
  }
  if (distances_.empty()) return 1;
  const auto middle = distances_.begin() + static_cast<std::ptrdiff_t>(distances_.size() / 2);
  std::nth_element(distances_.begin(), middle, distances_.end());
  const double scale = std::max(1.0, *middle / 1.1774);  // median of a Rayleigh distribution
  for (Seen& s : seen_) {
    if (s.weight < 0) {
      s.weight = 0;
      continue;
    }
    const double t = s.weight / (kTukey * scale);
    const double look = std::clamp((s.correlation - least_correlation) / 0.2, 0.05, 1.0);
    s.weight = t < 1 ? look * (1 - t * t) * (1 - t * t) : 0;
  }
  return scale;
}

/// Moves the pose by one step; false if the patches do not determine it.
bool PatchAlign::step(geometry::Pose& pose, double& moved) {
  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (const Seen& s : seen_) {
    if (s.weight <= 0) continue;
    const Eigen::Matrix<double, 6, 2> weighted = s.weight * s.jacobian.transpose() * s.information;
    normal += weighted * s.jacobian;
    right -= weighted * s.offset;
  }
  // A weak prior on the start, 0.3 rad and 0.5 m, which carries less information than any useful
  // picture.
  normal.diagonal().array() += 1e-9;
  normal.diagonal().head<3>().array() += 1 / (0.3 * 0.3);
  normal.diagonal().tail<3>().array() += 1 / (0.5 * 0.5);
  const geometry::Cholesky6 solver(normal);
  if (!solver.is_positive()) return false;
  const Vector6 x = solver.solve(right);
  if (!x.allFinite() || x.head<3>().norm() > 0.5 || x.tail<3>().norm() > 1) return false;
  const Eigen::Quaterniond turn = turn_by(x.head<3>());
  pose = {(turn * pose.rotation).normalized(), turn * pose.translation_m + x.tail<3>()};
  double most = 0;
  for (const Seen& s : seen_)
    if (s.weight > 0) most = std::max(most, (s.jacobian * x).cwiseAbs().maxCoeff());
  moved = most;
  return true;
}

PatchFit PatchAlign::align(const GreyPyramid& picture, const geometry::Pose& start) {
  return align(picture, start, coarsest_, options_.finest);
}

PatchFit PatchAlign::align(const GreyPyramid& picture, const geometry::Pose& start, int coarsest,
                           int finest) {
  PatchFit fit;
  fit.camera_from_room = start;
  coarsest = std::min(coarsest, picture.levels() - 1);
  for (int k = coarsest; k >= finest; --k) {
    const double least = k > finest ? 0.4 : 0.6;
    seen_.clear();
    for (const Patch* p : choice_.choose(fit.camera_from_room, k)) {
      seen_.emplace_back();
      seen_.back().patch = p;
    }
    for (int i = 0; i < options_.iterations; ++i) {
      for (Seen& s : seen_) look(picture, fit.camera_from_room, k, s);
      weigh(least);
      double moved = 0;
      if (!step(fit.camera_from_room, moved)) break;
      if (moved < kStill_px) break;
    }
  }
  for (Seen& s : seen_) look(picture, fit.camera_from_room, finest, s);
  const double scale = weigh(0.7);
  distances_.clear();
  for (const Seen& s : seen_) {
    if (!s.in_picture) continue;
    ++fit.visible;
    if (s.weight <= 0) continue;
    ++fit.inliers;
    distances_.push_back(s.offset.norm());
  }
  if (fit.inliers < 6) return fit;
  const auto middle = distances_.begin() + static_cast<std::ptrdiff_t>(distances_.size() / 2);
  std::nth_element(distances_.begin(), middle, distances_.end());
  fit.offset_px = *middle;
  fit.covariance = pose_covariance(seen_, fit.camera_from_room, scale);
  return fit;
}

}  // namespace mixrig::tracking
