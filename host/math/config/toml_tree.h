// SPDX-License-Identifier: Apache-2.0
// A TOML file as a plain tree with line numbers. Private to this module.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::config {

/// One value. An array holds `items`; a table holds `items` and their `keys`.
struct Node {
  enum class Kind { kTable, kArray, kText, kInteger, kNumber, kBoolean, kOther };
  Kind kind = Kind::kTable;
  int line = 0;  ///< line of the value, from 1
  std::variant<std::monostate, std::string, long long, double, bool> value;
  std::vector<std::string> keys;
  std::vector<Node> items;

  const Node* find(std::string_view key) const {
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i] == key) return &items[i];
    return nullptr;
  }
};

/// Parses TOML 1.0. Pure. Limits: text up to 1 MiB, keys of at most 16 parts.
/// Errors: kFormat, "name:line: why: what to do".
Result<Node> parse_toml(std::string_view text, const std::string& name);

}  // namespace mixrig::config
