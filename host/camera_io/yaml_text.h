// SPDX-License-Identifier: Apache-2.0
// Numbers and lists as YAML text; reading them back gives the same bits. Private to this room.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <Eigen/Core>

namespace mixrig::camera_io {

/// The shortest digits that stand for this double.
std::string digits(double value);
/// "[a, b, c]".
std::string list(const double* values, std::size_t count);
std::string list(const Eigen::VectorXd& values);
/// A row a line, each behind `indent` and "- ".
std::string rows(const Eigen::MatrixXd& matrix, const std::string& indent);
/// As a YAML scalar: quoted where it could be read as something else.
std::string yaml_string(std::string_view text);

}  // namespace mixrig::camera_io
