// SPDX-License-Identifier: Apache-2.0
// Documents: reading, the check for unknown keys, environment variables.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "host/math/config/document_state.h"
#include "host/math/config/file_kind.h"
#include "host/math/config/nearest.h"

namespace mixrig::config {
namespace {

constexpr std::size_t kMaxDocumentBytes = std::size_t{1} << 20;

}  // namespace

std::optional<std::string> Document::State::unknown_key(const Node& table,
                                                        const std::string& table_name) const {
  const auto read = known.find(&table);
  if (read == known.end()) return std::nullopt;  // not read at all: its own key is unknown
  for (std::size_t i = 0; i < table.keys.size(); ++i) {
    const std::string key = dotted(table_name, table.keys[i]);
    const Node& item = table.items[i];
    if (!read->second.contains(table.keys[i])) {
      const auto meant = nearest(table.keys[i], {read->second.begin(), read->second.end()});
      return fmt::format("{}:{}: key \"{}\": not known: {}", name, item.line, key,
                         meant ? "did you mean \"" + *meant + "\"?" : "remove it");
    }
    if (item.kind == Node::Kind::kTable)
      if (auto found = unknown_key(item, key)) return found;
    if (item.kind == Node::Kind::kArray)
      for (const Node& element : item.items)
        if (auto found = unknown_key(element, key)) return found;
  }
  return std::nullopt;
}

Document::Document(std::unique_ptr<State> state) : state_(std::move(state)) {}
Document::Document(Document&&) noexcept = default;
Document& Document::operator=(Document&&) noexcept = default;
Document::~Document() = default;

Result<Document> Document::read(const std::filesystem::path& path) {
  MIXRIG_ASSIGN(const std::string text, read_text(path, kMaxDocumentBytes));
  return parse(text, path.string());
}

Result<Document> Document::parse(std::string_view text, const std::string& name) {
  MIXRIG_ASSIGN(Node root, parse_toml(text, name));
  auto state = std::make_unique<State>();
  state->name = name;
  state->root = std::move(root);
  return Document(std::move(state));
}

Table Document::root() { return {this, &state_->root, ""}; }

Result<void> Document::finish() const {
  const auto asked = state_->known.find(&state_->root);
  if (asked != state_->known.end())
    if (const std::string kind = other_kind(state_->root.keys, asked->second); !kind.empty())
      return Error{ErrorCode::kFormat, state_->name + ": " + kind};
  // A misspelt key is reported before the value that is missing because of it.
  if (auto unknown = state_->unknown_key(state_->root, ""))
    return Error{ErrorCode::kFormat, *unknown};
  if (state_->first_error) return Error{ErrorCode::kFormat, *state_->first_error};
  return {};
}

std::filesystem::path path_at(const Table& table, std::string_view key,
                              const std::filesystem::path& folder) {
  const auto expanded = expand_environment(table.text(key));
  if (expanded) return expanded->empty() ? "" : (folder / *expanded).lexically_normal();
  table.fail(key, expanded.error());
  return {};
}

Result<std::string> expand_environment(const std::string& text) {
  std::string out;
  std::size_t at = 0;
  for (;;) {
    const std::size_t open = text.find("${", at);
    out += text.substr(at, open - at);
    if (open == std::string::npos) return out;
    const std::size_t close = text.find('}', open);
    if (close == std::string::npos)
      return Error{ErrorCode::kUsage, "\"" + text + "\": \"${\" without \"}\": close it"};
    const std::string name = text.substr(open + 2, close - open - 2);
    const char* value = std::getenv(name.c_str());
    if (value == nullptr)
      return Error{ErrorCode::kUsage, "environment variable " + name +
                                          " is not set: set it to the folder that the file means"};
    out += value;
    at = close + 1;
  }
}

Result<std::string> read_text(const std::filesystem::path& path, std::size_t max_bytes) {
  const std::string what = "cannot read '" + path.string() + "'";
  const auto unread = [&](int why) {
    const bool is_elsewhere = why == ENOENT || why == ENOTDIR || why == EISDIR;
    Error error = system_error(ErrorCode::kNotFound, what, why);
    error.context += is_elsewhere
                         ? ": " + advice_for_unread(path.filename().string(), why == EISDIR)
                         : ": check its rights";
    return error;
  };
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return unread(errno);
  std::string text;
  std::error_code unknown;  // of a pipe
  const auto bytes = std::filesystem::file_size(path, unknown);
  if (!unknown) text.reserve(std::min<std::uintmax_t>(bytes, max_bytes) + 1);
  char part[16384];
  errno = 0;
  while (text.size() <= max_bytes) {
    const std::size_t count = std::fread(part, 1, sizeof(part), file);
    if (count == 0) break;
    text.append(part, count);
  }
  const int read_errno = std::ferror(file) != 0 ? errno : 0;
  std::fclose(file);
  if (read_errno != 0) return unread(read_errno);
  if (const std::string kind = binary_kind(text); !kind.empty())
    return Error{ErrorCode::kFormat, what + ": it is " + kind};
  if (text.size() > max_bytes)
    return Error{ErrorCode::kFormat, what + ": larger than " + std::to_string(max_bytes) +
                                         " bytes: give the right file"};
  return text;
}

}  // namespace mixrig::config
