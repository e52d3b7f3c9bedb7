// SPDX-License-Identifier: Apache-2.0
// What a document and its tables share. Private to this room.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "host/config/table.h"
#include "host/config/toml_tree.h"

namespace mixrig::config {

struct Document::State {
  std::string name;  ///< of the file
  Node root;
  std::map<const Node*, std::set<std::string, std::less<>>> known;  ///< keys asked for, a table
  std::optional<std::string> first_error;

  /// "NAME:LINE: ..." of the first unknown key below `table`, if any.
  std::optional<std::string> unknown_key(const Node& table, const std::string& table_name) const;

  void note(int line, const std::string& key, const std::string& what) {
    if (!first_error)
      first_error = name + ":" + std::to_string(line) + ": key \"" + key + "\": " + what;
  }
};

inline std::string dotted(std::string_view table, std::string_view key) {
  return table.empty() ? std::string(key) : std::string(table) + "." + std::string(key);
}

}  // namespace mixrig::config
