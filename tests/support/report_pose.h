// SPDX-License-Identifier: Apache-2.0
// Compares poses in a report of `mixrig calibrate rig` with those of truth.json.
#pragma once

#include <cmath>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace mixrig::test {

inline Eigen::Vector3d vector_of(const nlohmann::json& j) {
  return {j.at(0).get<double>(), j.at(1).get<double>(), j.at(2).get<double>()};
}
inline Eigen::Quaterniond rotation_of(const nlohmann::json& j) {
  const nlohmann::json& q = j.at("rotation_xyzw");
  return {q.at(3).get<double>(), q.at(0).get<double>(), q.at(1).get<double>(),
          q.at(2).get<double>()};
}
inline double off_mm(const nlohmann::json& a, const nlohmann::json& b) {
  return 1000 * (vector_of(a.at("translation_m")) - vector_of(b.at("translation_m"))).norm();
}
inline double off_deg(const nlohmann::json& a, const nlohmann::json& b) {
  return rotation_of(a).angularDistance(rotation_of(b)) * 180 / M_PI;
}

}  // namespace mixrig::test
