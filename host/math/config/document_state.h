// SPDX-License-Identifier: Apache-2.0
// State that a document and its tables share. Private to this module.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host/math/config/table.h"
#include "host/math/config/toml_tree.h"

namespace mixrig::config {

struct Document::State {
  std::string name;  ///< name of the file
  Node root;
  std::map<const Node*, std::set<std::string, std::less<>>>
      known;  ///< keys that were read, by table
  std::optional<std::string> first_error;

  /// "NAME:LINE: ..." of the first unknown key below `table`, if any.
  std::optional<std::string> unknown_key(const Node& table, const std::string& table_name) const;

  void note(int line, const std::string& key, const std::string& what) {
    if (!first_error) first_error = fmt::format("{}:{}: key \"{}\": {}", name, line, key, what);
  }
};

inline std::string dotted(std::string_view table, std::string_view key) {
  return table.empty() ? std::string(key) : std::string(table) + "." + std::string(key);
}

}  // namespace mixrig::config
