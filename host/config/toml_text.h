// SPDX-License-Identifier: Apache-2.0
// Values as TOML text, for manifests that the program writes.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mixrig::config {

/// A basic string in quotes, with escapes.
std::string toml_text(std::string_view text);
/// The shortest text that reads back as the same number.
std::string toml_number(double value);
/// "[a, b, c]".
std::string toml_array(std::span<const double> values);

}  // namespace mixrig::config
