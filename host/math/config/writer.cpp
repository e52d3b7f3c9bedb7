// SPDX-License-Identifier: Apache-2.0
// The layout of TOML files. toml++ 3.3 escapes their text, but its formatter for whole tables is
// not used: it sorts keys, writes a key with a quote or a line break bare, and doubles with 17
// digits.
#include "host/math/config/writer.h"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace mixrig::config {
namespace {

constexpr std::size_t kLongestLine = 120;  ///< a longer matrix is written one row a line

std::string quoted(std::string_view text) {
  std::ostringstream out;
  const toml::value<std::string> value{std::string(text)};
  out << toml::toml_formatter(value, toml::format_flags::allow_unicode_strings);
  return out.str();
}

std::string key_text(std::string_view key) {
  const bool bare = std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
  return bare && !key.empty() ? std::string(key) : quoted(key);
}

/// Formats a float, which has a point or an exponent in TOML.
std::string number_text(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string number_text(int value) { return fmt::format("{}", value); }

template <typename T>
std::string array_text(std::span<const T> values) {
  std::vector<std::string> texts;
  for (const T value : values) texts.push_back(number_text(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

}  // namespace

struct Writer::State {
  struct Value {
    std::string key, text;
  };
  struct Tables {
    std::string key;
    bool is_array = false;
    std::vector<Writer> tables;  ///< one element if it is no array
  };

  /// Appends the values of this table, then its tables. `path` is its dotted key.
  void write(std::string& out, const std::string& path) const;

  std::vector<Value> values;
  std::vector<Tables> tables;
};

void Writer::State::write(std::string& out, const std::string& path) const {
  for (const Value& value : values) out += fmt::format("{} = {}\n", value.key, value.text);
  for (const Tables& child : tables)
    for (const Writer& table : child.tables) {
      const std::string name = path.empty() ? child.key : path + "." + child.key;
      // A table that holds only tables needs no header of its own.
      const bool header =
          child.is_array || !table.state_->values.empty() || table.state_->tables.empty();
      if (header && !out.empty()) out += "\n";
      if (header) out += fmt::format(fmt::runtime(child.is_array ? "[[{}]]\n" : "[{}]\n"), name);
      table.state_->write(out, name);
    }
}

Writer::Writer() : state_(std::make_unique<State>()) {}
Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;
Writer::~Writer() = default;

Writer& Writer::set_text(std::string_view key, std::string value) {
  auto& values = state_->values;
  const std::string text = key_text(key);
  const auto at = std::find_if(values.begin(), values.end(),
                               [&](const State::Value& v) { return v.key == text; });
  if (at != values.end())
    at->text = std::move(value);
  else
    values.push_back({text, std::move(value)});
  return *this;
}

Writer& Writer::set(std::string_view key, std::string_view text) {
  return set_text(key, quoted(text));
}

Writer& Writer::set(std::string_view key, const char* text) {
  return set(key, std::string_view(text));
}

Writer& Writer::set(std::string_view key, bool value) {
  return set_text(key, value ? "true" : "false");
}

Writer& Writer::set(std::string_view key, int value) { return set_text(key, number_text(value)); }

Writer& Writer::set(std::string_view key, double value) {
  return set_text(key, number_text(value));
}

Writer& Writer::set(std::string_view key, Size size) {
  return set_text(key, fmt::format("[{}, {}]", size.width, size.height));
}

Writer& Writer::set(std::string_view key, std::span<const int> values) {
  return set_text(key, array_text(values));
}

Writer& Writer::set(std::string_view key, std::span<const double> values) {
  return set_text(key, array_text(values));
}

Writer& Writer::set_matrix(std::string_view key, std::size_t columns,
                           std::span<const double> values) {
  std::vector<std::string> rows;
  for (std::size_t at = 0; at + columns <= values.size(); at += columns)
    rows.push_back(array_text(values.subspan(at, columns)));
  std::string text = fmt::format("[{}]", fmt::join(rows, ", "));
  if (text.size() > kLongestLine) text = fmt::format("[\n  {},\n]", fmt::join(rows, ",\n  "));
  return set_text(key, std::move(text));
}

Writer& Writer::set(std::string_view key, Writer table) {
  state_->tables.push_back({key_text(key), false, {}});
  state_->tables.back().tables.push_back(std::move(table));
  return *this;
}

Writer& Writer::add(std::string_view key, Writer table) {
  auto& tables = state_->tables;
  const std::string text = key_text(key);
  auto at = std::find_if(tables.begin(), tables.end(),
                         [&](const State::Tables& t) { return t.is_array && t.key == text; });
  if (at == tables.end()) at = tables.insert(at, {text, true, {}});
  at->tables.push_back(std::move(table));
  return *this;
}

std::string Writer::text() const {
  std::string out;
  state_->write(out, "");
  return out;
}

double rounded(double value, int significant_digits) {
  const std::string text = fmt::format("{:.{}g}", value, significant_digits);
  double result = value;
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

}  // namespace mixrig::config
