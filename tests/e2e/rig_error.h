// SPDX-License-Identifier: Apache-2.0
// Poses of a report of mixrig calibrate rig against those of truth.json; commands that are refused.
#pragma once

#include <cmath>

#include <Eigen/Geometry>

#include "tests/e2e/command.h"

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
inline std::string text_of_file(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Removes the table [fisheye] of a take.toml.
inline void leave_out_fisheye(const std::string& take_toml) {
  const std::string text = text_of_file(take_toml);
  const std::size_t begin = text.find("[fisheye]"), end = text.find("\n[", begin);
  ASSERT_NE(end, std::string::npos);
  std::ofstream(take_toml) << text.substr(0, begin) << text.substr(end + 1);
}

class RefusingCommandTest : public CommandTest {
 protected:
  /// Exit status of a command that is expected to fail; `error_line` gets its error line.
  int refused(const std::string& words, std::string& error_line) const {
    const std::string line =
        std::string(MIXRIG_COMMAND) + " " + words + " >/dev/null 2>" + path("err");
    const int status = std::system(line.c_str());
    error_line = text_of_file(path("err"));
    return WEXITSTATUS(status);
  }
};

}  // namespace mixrig::test
