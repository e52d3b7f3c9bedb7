// SPDX-License-Identifier: Apache-2.0
#include "host/camera_io/yaml_text.h"

#include <charconv>

namespace mixrig::camera_io {

std::string digits(double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
  return {text, end};
}

std::string list(const double* values, std::size_t count) {
  std::string text = "[";
  for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + digits(values[i]);
  return text + "]";
}

std::string list(const Eigen::VectorXd& values) {
  return list(values.data(), static_cast<std::size_t>(values.size()));
}

std::string rows(const Eigen::MatrixXd& matrix, const std::string& indent) {
  std::string text;
  for (int r = 0; r < matrix.rows(); ++r)
    text += indent + "- " + list(Eigen::VectorXd(matrix.row(r))) + "\n";
  return text;
}

std::string yaml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + "\"";
}

}  // namespace mixrig::camera_io
