// SPDX-License-Identifier: Apache-2.0
// Reads TOML manifests: typed values with ranges, and a one-line error.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::config {

/// Allowed numbers, both ends included. NaN and infinity are never allowed.
struct Range {
  double min = std::numeric_limits<double>::lowest();
  double max = std::numeric_limits<double>::max();
};
inline constexpr Range kPositive{1e-12, 1e12};
inline constexpr Range kNotNegative{0.0, 1e12};

struct Node;
class Document;

/// One table of a document. Getters do not fail at once: the document notes the first thing that is
/// wrong, the getter returns a default, and Document::finish() returns the error. A key counts as
/// known once a getter has read it. The document must outlive its tables. Not thread-safe.
class Table {
 public:
  /// False for an optional table that the file does not have; getters then return defaults.
  bool present() const { return node_ != nullptr; }
  bool has(std::string_view key) const;
  /// True where the key is there and holds one number.
  bool is_number(std::string_view key) const;
  /// Returns the keys of this table in alphabetical order. This does not make them known.
  std::vector<std::string> keys() const;
  /// Number of elements of the array of that key; 0 where the key is absent or holds no array.
  std::size_t size_of(std::string_view key) const;

  double number(std::string_view key, Range range = {}) const;
  double number_or(std::string_view key, double fallback, Range range = {}) const;
  int integer(std::string_view key, Range range) const;
  int integer_or(std::string_view key, int fallback, Range range) const;
  bool boolean_or(std::string_view key, bool fallback) const;
  std::string text(std::string_view key) const;
  std::string text_or(std::string_view key, std::string_view fallback) const;
  /// Returns the index of the key's word in `words`; `fallback` where the key is absent.
  int one_of(std::string_view key, const std::vector<std::string>& words, int fallback) const;
  /// Reads between `min_count` and `max_count` numbers. If one is enough, a number without brackets
  /// is accepted too.
  std::vector<double> numbers(std::string_view key, std::size_t min_count, std::size_t max_count,
                              Range range = {}) const;
  /// Reads `rows` arrays of `columns` finite numbers, row by row.
  std::vector<double> matrix(std::string_view key, std::size_t rows, std::size_t columns) const;
  /// Returns a table that may be absent.
  Table table(std::string_view key) const;
  /// Returns a table that must exist.
  Table required_table(std::string_view key) const;
  /// Returns an array of tables, [[key]]; empty where absent.
  std::vector<Table> tables(std::string_view key) const;

  /// Notes "FILE:LINE: key "KEY": WHAT" about this key, or about the table if it lacks the key.
  void fail(std::string_view key, const std::string& what) const;
  /// Notes an error that another module returned about this key.
  void fail(std::string_view key, const Error& error) const;

 private:
  friend class Document;
  Table(Document* document, const Node* node, std::string name)
      : document_(document), node_(node), name_(std::move(name)) {}
  const Node* find(std::string_view key, bool required) const;
  void wrong_type(std::string_view key, std::string_view wanted) const;
  bool check(std::string_view key, double value, Range range) const;
  Table child(std::string_view key, const Node* node) const;

  Document* document_;
  const Node* node_;
  std::string name_;  ///< dotted name in the file, empty for the root
};

/// A TOML file, with the keys that were read and the first error that was noted.
class Document {
 public:
  /// Errors: kNotFound, kFormat (file:line).
  static Result<Document> read(const std::filesystem::path& path);
  /// Parses text; `name` stands for the file. Pure: fuzzers call it.
  static Result<Document> parse(std::string_view text, const std::string& name);
  Document(Document&&) noexcept;
  Document& operator=(Document&&) noexcept;
  ~Document();

  Table root();
  /// Call when every key has been read. Errors: kFormat for a key that was not read, with the
  /// nearest known key; else the first error that getters and fail() noted.
  Result<void> finish() const;

 private:
  friend class Table;
  struct State;
  explicit Document(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Replaces each ${NAME} by the environment variable. Errors: kUsage where it is not set, or a
/// brace is not closed.
Result<std::string> expand_environment(const std::string& text);

/// Returns the file or folder that `key` names, relative to `folder`; ${NAME} is an environment
/// variable. Empty if the key is absent from an optional table, or wrong (which is noted).
std::filesystem::path path_at(const Table& table, std::string_view key,
                              const std::filesystem::path& folder);

/// Returns the whole text of a file of at most `max_bytes`. Errors: kNotFound, kFormat if it is
/// larger.
Result<std::string> read_text(const std::filesystem::path& path, std::size_t max_bytes);

}  // namespace mixrig::config
