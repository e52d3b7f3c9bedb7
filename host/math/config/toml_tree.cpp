// SPDX-License-Identifier: Apache-2.0
// Converts toml++'s result to a plain tree of limited size.
#include "host/math/config/toml_tree.h"

#include <algorithm>
#include <cctype>

#include <toml++/toml.h>

namespace mixrig::config {
namespace {

constexpr std::size_t kMaxTomlBytes = std::size_t{1} << 20;
constexpr int kMaxKeyParts = 16;

/// Returns the line of a dotted key with too many parts, 0 if there is none. toml++ limits the
/// depth of brackets but not of dotted keys, and frees a tree by recursion: such a key would
/// overflow the stack.
int line_of_deep_key(std::string_view text) {
  int line = 1, dots = 0;
  for (const char c : text) {
    if (c == '\n') ++line;
    if (c == '.') ++dots;
    const bool in_key = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                        std::string_view("._-\"' \t").find(c) != std::string_view::npos;
    if (!in_key) dots = 0;
    if (dots > kMaxKeyParts) return line;
  }
  return 0;
}

Node convert(const toml::node& source) {
  Node node;
  node.line = static_cast<int>(source.source().begin.line);
  if (const auto* table = source.as_table()) {
    for (const auto& [key, child] : *table) {
      node.keys.emplace_back(key.str());
      node.items.push_back(convert(child));
    }
  } else if (const auto* array = source.as_array()) {
    node.kind = Node::Kind::kArray;
    for (const auto& child : *array) node.items.push_back(convert(child));
  } else if (const auto* text = source.as_string()) {
    node.kind = Node::Kind::kText, node.value = text->get();
  } else if (const auto* integer = source.as_integer()) {
    node.kind = Node::Kind::kInteger, node.value = static_cast<long long>(integer->get());
  } else if (const auto* number = source.as_floating_point()) {
    node.kind = Node::Kind::kNumber, node.value = number->get();
  } else if (const auto* boolean = source.as_boolean()) {
    node.kind = Node::Kind::kBoolean, node.value = boolean->get();
  } else {
    node.kind = Node::Kind::kOther;  // dates and times: no key of ours takes them
  }
  return node;
}

Error bad_text(const std::string& name, long line, const std::string& why) {
  return Error{ErrorCode::kFormat, name + ":" + std::to_string(line) + ": " + why};
}

}  // namespace

Result<Node> parse_toml(std::string_view text, const std::string& name) {
  if (text.size() > kMaxTomlBytes)
    return bad_text(name, 1, "larger than 1 MiB: give the right file");
  if (const int line = line_of_deep_key(text); line != 0)
    return bad_text(name, line, "a key of more than 16 parts: remove it");
  try {
    return convert(toml::parse(text, name));
  } catch (const toml::parse_error& error) {
    const std::string_view why = error.description();
    std::string line(why.substr(0, 200));
    std::replace(line.begin(), line.end(), '\n', ' ');
    return bad_text(name, static_cast<long>(error.source().begin.line),
                    "not valid TOML: " + line + ": correct the line");
  } catch (const std::exception& error) {
    return bad_text(name, 1, std::string("not valid TOML: ") + error.what());
  }
}

}  // namespace mixrig::config
