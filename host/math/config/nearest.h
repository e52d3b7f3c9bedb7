// SPDX-License-Identifier: Apache-2.0
// The known word that is nearest to a misspelt one.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mixrig::config {

/// Returns the number of insertions, deletions and replacements that lead from a to b (Levenshtein
/// 1966).
int edit_distance(std::string_view a, std::string_view b);

/// Returns the known word with the least edit distance; nullopt if every known word needs more
/// edits than half of its length.
std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known);

}  // namespace mixrig::config
