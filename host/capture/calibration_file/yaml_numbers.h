// SPDX-License-Identifier: Apache-2.0
// Writes numbers to YAML so that reading them back gives the same bits. Private to this module.
#pragma once

#include <span>
#include <string>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace mixrig::calibration_file {

/// Emits [a, b, c] with the fewest digits that read back as the same double; yaml-cpp itself has
/// only a fixed precision. A number with an exponent gets a point too: YAML 1.1, and so Kalibr's
/// PyYAML, reads 1e-05 as text.
inline void emit_numbers(YAML::Emitter& out, std::span<const double> values) {
  out << YAML::Flow << YAML::BeginSeq;
  for (const double value : values) {
    std::string text = fmt::format("{}", value);
    if (const auto e = text.find('e');
        e != std::string::npos && text.find('.') == std::string::npos)
      text.insert(e, ".0");
    out << text;
  }
  out << YAML::EndSeq;
}

}  // namespace mixrig::calibration_file
