// SPDX-License-Identifier: Apache-2.0
// Light of a lamp on a surface. The lanes of host/render/cpu/light and the shaders compute the
// same.
#pragma once

#include <optional>

#include <Eigen/Core>

namespace mixrig::geometry {

/// Irradiance at `at_m` on a surface with the unit `normal`, by a point of intensity 1 at `lamp_m`
/// that nothing hides, 1/m^2: cos(receiver) [cos(emitter)] / d^2, the bracket only where the lamp
/// has a `direction` (unit). Not less than 0; within 1 mm of the lamp d is 1 mm. All in one frame.
/// Pure.
double irradiance(const Eigen::Vector3d& lamp_m, const std::optional<Eigen::Vector3d>& direction,
                  const Eigen::Vector3d& at_m, const Eigen::Vector3d& normal);

}  // namespace mixrig::geometry
