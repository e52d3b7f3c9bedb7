// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/any_camera.h"

#include <algorithm>
#include <cmath>

#include "host/math/geometry/lens_equations.h"

namespace mixrig::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Projection project_pinhole(const double* v, const Vector3d& p) {
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  const double *k = v + 4, p1 = k[2], p2 = k[3];
  const Radial at = radial(k, r2);
  const Vector2d tilt(2 * x * y, r2 + 2 * x * x);    // d x_d / d (p1, p2)
  const Vector2d tilt_y(r2 + 2 * y * y, 2 * x * y);  // d y_d / d (p1, p2)
  const Vector2d bent(x * at.gain + p1 * tilt[0] + p2 * tilt[1],
                      y * at.gain + p1 * tilt_y[0] + p2 * tilt_y[1]);
  const Vector2d focal(v[0], v[1]);
  Projection out;
  out.px = focal.cwiseProduct(bent) + Vector2d(v[2], v[3]);

  Eigen::Matrix2d d_bent;
  d_bent(0, 0) = at.gain + 2 * x * x * at.derivative + 2 * p1 * y + 6 * p2 * x;
  d_bent(0, 1) = d_bent(1, 0) = 2 * x * y * at.derivative + 2 * p1 * x + 2 * p2 * y;
  d_bent(1, 1) = at.gain + 2 * y * y * at.derivative + 6 * p1 * y + 2 * p2 * x;
  Eigen::Matrix<double, 2, 3> d_ideal;
  d_ideal << 1, 0, -x, 0, 1, -y;
  out.d_point = focal.asDiagonal() * d_bent * d_ideal / p.z();

  auto& d = out.d_parameters;
  d.setZero(2, kPinholeParameters);
  d(0, 0) = bent.x();
  d(1, 1) = bent.y();
  d(0, 2) = d(1, 3) = 1;
  const Vector2d scaled(v[0] * x, v[1] * y);
  const double up = r2 / at.denominator, down = -at.gain * up;
  d.col(4) = scaled * up;
  d.col(5) = scaled * (up * r2);
  d.col(6) = Vector2d(v[0] * tilt[0], v[1] * tilt_y[0]);
  d.col(7) = Vector2d(v[0] * tilt[1], v[1] * tilt_y[1]);
  d.col(8) = scaled * (up * r2 * r2);
  d.col(9) = scaled * down;
  d.col(10) = scaled * (down * r2);
  d.col(11) = scaled * (down * r2 * r2);
  return out;
}

Projection project_fisheye(const double* v, const Vector3d& p) {
  const double *k = v + 4, r2 = p.x() * p.x() + p.y() * p.y(), r = std::sqrt(r2), z = p.z();
  const double theta = std::atan2(r, z), n2 = r2 + z * z;
  const Vector2d xy = p.head<2>(), focal(v[0], v[1]);
  // Near the axis theta_d / r tends to 1 / z, and the terms of its derivative cancel.
  const bool on_axis = r < 1e-9 * std::abs(z);
  const double gain = on_axis ? 1 / z : bend(k, theta) / r;
  const double slope = bend_slope(k, theta);
  const double gain_r_over_r = on_axis ? 0 : (slope * z / n2 - gain) / r2;
  Projection out;
  out.px = gain * focal.cwiseProduct(xy) + Vector2d(v[2], v[3]);
  Eigen::Matrix<double, 2, 3> d_bent;
  d_bent.leftCols<2>() = gain * Eigen::Matrix2d::Identity() + gain_r_over_r * xy * xy.transpose();
  d_bent.col(2) = -slope / n2 * xy;
  out.d_point = focal.asDiagonal() * d_bent;

  auto& d = out.d_parameters;
  d.setZero(2, kFisheyeParameters);
  d(0, 0) = gain * xy.x();
  d(1, 1) = gain * xy.y();
  d(0, 2) = d(1, 3) = 1;
  double power = on_axis ? 0 : theta * theta * theta / r;
  for (int i = 4; i < kFisheyeParameters; ++i, power *= theta * theta)
    d.col(i) = power * focal.cwiseProduct(xy);
  return out;
}

}  // namespace

std::vector<std::string_view> parameter_names(LensKind kind) {
  if (kind == LensKind::kFisheye) return {"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"};
  return {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
}

std::string_view name_of(LensKind kind) {
  return kind == LensKind::kPinhole ? "pinhole" : "fisheye";
}

LensKind kind_of(const AnyCamera& camera) {
  return std::holds_alternative<CameraModel>(camera) ? LensKind::kPinhole : LensKind::kFisheye;
}

Size size_px(const AnyCamera& camera) {
  return std::visit([](const auto& model) { return model.size_px(); }, camera);
}

Eigen::VectorXd parameters_of(const AnyCamera& camera) {
  Eigen::VectorXd v(parameter_count(kind_of(camera)));
  if (const auto* model = std::get_if<CameraModel>(&camera)) {
    const auto& [size, fx, fy, cx, cy] = model->pinhole;
    v.head<4>() << fx, fy, cx, cy;
    std::copy_n(model->lens.coefficients().begin(), 8, v.data() + 4);
  } else {
    const auto& p = std::get<FisheyeModel>(camera).parameters();
    v.head<4>() << p.fx_px, p.fy_px, p.cx_px, p.cy_px;
    std::copy_n(p.k.begin(), 4, v.data() + 4);
  }
  return v;
}

std::optional<double> max_angle_rad(const AnyCamera& camera) {
  const auto* fisheye = std::get_if<FisheyeModel>(&camera);
  return fisheye != nullptr ? fisheye->parameters().max_angle_rad : std::nullopt;
}

AnyCamera make_camera(LensKind kind, Size size_px, const Eigen::VectorXd& v,
                      std::optional<double> max_angle_rad) {
  assert(v.size() == parameter_count(kind));
  assert(kind == LensKind::kFisheye || !max_angle_rad);
  if (kind == LensKind::kFisheye)
    return FisheyeModel({size_px, v[0], v[1], v[2], v[3], {v[4], v[5], v[6], v[7]}, max_angle_rad});
  Lens::Coefficients k{};
  std::copy_n(v.data() + 4, 8, k.begin());
  return CameraModel{{size_px, v[0], v[1], v[2], v[3]}, Lens(k)};
}

std::optional<Vector2d> project(const AnyCamera& camera, const Vector3d& p) {
  return std::visit([&](const auto& model) { return model.project(p); }, camera);
}

std::optional<Vector3d> unproject(const AnyCamera& camera, const Vector2d& px) {
  if (const auto* fisheye = std::get_if<FisheyeModel>(&camera)) return fisheye->unproject(px);
  const auto at = std::get<CameraModel>(camera).unproject(px);
  if (!at) return std::nullopt;
  return Vector3d(at->x(), at->y(), 1).normalized();
}

Result<void> validate(const AnyCamera& camera) {
  return std::visit([](const auto& model) { return validate(model); }, camera);
}

std::optional<Projection> project_with_jacobians(LensKind kind, const double* parameters,
                                                 const Vector3d& p) {
  const double r2 = p.x() * p.x() + p.y() * p.y();
  if (kind == LensKind::kPinhole ? !(p.z() > 0) : !(r2 > 0 || p.z() > 0)) return std::nullopt;
  const Projection out =
      kind == LensKind::kPinhole ? project_pinhole(parameters, p) : project_fisheye(parameters, p);
  if (!out.px.allFinite() || !out.d_point.allFinite()) return std::nullopt;
  return out;
}

}  // namespace mixrig::geometry
