// SPDX-License-Identifier: Apache-2.0
// Conversions between Eigen's and glm's vectors and matrices.
#pragma once

#include <Eigen/Core>
#include <glm/glm.hpp>

namespace mixrig::render {

inline glm::vec3 to_glm(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }
inline glm::dvec2 to_glm(const Eigen::Vector2d& v) { return {v.x(), v.y()}; }
inline glm::dvec3 to_glm(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline glm::dmat4 to_glm(const Eigen::Matrix4d& m) {
  glm::dmat4 out;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) out[column][row] = m(row, column);
  return out;
}

inline Eigen::Vector3f to_eigen(const glm::vec3& v) { return {v.x, v.y, v.z}; }
inline Eigen::Vector3d to_eigen(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

}  // namespace mixrig::render
