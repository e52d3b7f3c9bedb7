// SPDX-License-Identifier: Apache-2.0
// Lamps, and their light on a surface. The lanes of host/render/cpu/light and the shaders compute
// the same irradiance.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace mixrig::geometry {

/// A lamp; its size softens shadows.
struct Lamp {
  Eigen::Vector3d position_m{0, 0, 0};         ///< world; the middle of a panel
  std::optional<Eigen::Vector3d> direction{};  ///< unit, world; a panel that faces this way
  Eigen::Vector2d size_m{0, 0};                ///< along panel_axes(); 0 for a point
  Eigen::Vector3f intensity{1, 1, 1};          ///< linear RGB
  std::string name{};                          ///< for display; may be empty

  bool is_dark() const { return intensity == Eigen::Vector3f::Zero(); }
};

/// A diffuse surface of albedo a shows the linear plate value
/// exposure * a * (ambient + sum of intensity times irradiance() over the lamps).
struct Light {
  Eigen::Vector3f ambient{0.3F, 0.3F, 0.3F};  ///< linear RGB
  double exposure = 1;
  std::vector<Lamp> lamps;
  /// Objects receive as ambient light what the learned room sends from each direction, and
  /// `ambient` from directions where nothing was learned.
  bool by_direction = false;
  bool contact = false;  ///< objects occlude ambient light for near surfaces and themselves
};

/// Axes of a panel: u horizontal (x of the world where the panel faces up or down), v across.
struct PanelAxes {
  Eigen::Vector3d u, v;
};
/// Returns the axes of a panel that faces along the unit `normal`, world. Pure.
PanelAxes panel_axes(const Eigen::Vector3d& normal);

/// Returns the irradiance of an unoccluded point lamp per unit of its intensity, 1/m^2, on a
/// surface at `at_m` with the unit `normal` (both world): cos(receiver) [cos(emitter)] / d^2. The
/// bracket applies only if the lamp has a direction. Never below 0; within 1 mm of the lamp d is 1
/// mm. Pure.
double irradiance(const Lamp& lamp, const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal);

}  // namespace mixrig::geometry
