// SPDX-License-Identifier: Apache-2.0
// A camera of either lens model, its parameters as a vector, and projection with derivatives, for
// calibrations and their files.
#pragma once

#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/fisheye_model.h"

namespace mixrig::geometry {

using AnyCamera = std::variant<CameraModel, FisheyeModel>;

enum class LensKind { kPinhole, kFisheye };

/// Number of parameters: fx fy cx cy, then k1 k2 p1 p2 k3 k4 k5 k6 (pinhole) or k1 k2 k3 k4
/// (fisheye).
inline constexpr int kPinholeParameters = 12, kFisheyeParameters = 8;
constexpr int parameter_count(LensKind kind) {
  return kind == LensKind::kPinhole ? kPinholeParameters : kFisheyeParameters;
}
/// Names of the parameters, in order.
std::vector<std::string_view> parameter_names(LensKind kind);
/// "pinhole" or "fisheye".
std::string_view name_of(LensKind kind);

LensKind kind_of(const AnyCamera& camera);
Size size_px(const AnyCamera& camera);
Eigen::VectorXd parameters_of(const AnyCamera& camera);
/// Returns the stated largest angle from the axis of a fisheye; nullopt for a pinhole.
std::optional<double> max_angle_rad(const AnyCamera& camera);
/// Precondition: as many parameters as the kind has, and a largest angle for a fisheye alone.
AnyCamera make_camera(LensKind kind, Size size_px, const Eigen::VectorXd& parameters,
                      std::optional<double> max_angle_rad = std::nullopt);

/// Pixel of a point in camera axes; nullopt outside the domain of the model.
std::optional<Eigen::Vector2d> project(const AnyCamera& camera, const Eigen::Vector3d& p);
/// Unit direction of a pixel; nullopt where the lens has no ray.
std::optional<Eigen::Vector3d> unproject(const AnyCamera& camera, const Eigen::Vector2d& px);
/// Validates the camera by its model. Errors: those of the model's validate().
Result<void> validate(const AnyCamera& camera);

/// A pixel and its derivatives.
struct Projection {
  Eigen::Vector2d px;
  Eigen::Matrix<double, 2, 3> d_point;
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kPinholeParameters> d_parameters;
};
/// Projects with `parameters` and differentiates, for solvers. The domain of the model is not
/// checked, since that costs more than the projection. Returns nullopt where the model has no pixel
/// at all: behind a pinhole, on the fisheye's backward axis, at the centre, or where the pixel is
/// not finite.
std::optional<Projection> project_with_jacobians(LensKind kind, const double* parameters,
                                                 const Eigen::Vector3d& p);

}  // namespace mixrig::geometry
