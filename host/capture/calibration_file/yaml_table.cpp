// SPDX-License-Identifier: Apache-2.0
#include "host/capture/calibration_file/yaml_table.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace mixrig::calibration_file {
namespace {

std::string count_text(std::size_t min_count, std::size_t max_count) {
  return min_count == max_count
             ? fmt::format("must be a list of {} numbers", min_count)
             : fmt::format("must be a list of {} to {} numbers", min_count, max_count);
}

}  // namespace

void YamlTable::note(const YAML::Node& node, const std::string& key,
                     const std::string& what) const {
  if (notes_->first_error) return;
  // An undefined node has no mark; its table has.
  const int line = node.IsDefined() ? node.Mark().line : node_.IsDefined() ? node_.Mark().line : -1;
  notes_->first_error = notes_->file + (line >= 0 ? ":" + std::to_string(line + 1) : "") +
                        ": key \"" + (name_.empty() ? key : name_ + "." + key) + "\": " + what;
}

YAML::Node YamlTable::find(const std::string& key) const {
  // A separate undefined node is returned, since yaml-cpp's zombie nodes throw when they are used.
  static const YAML::Node absent(YAML::NodeType::Undefined);
  if (!present()) return absent;
  for (const auto& item : node_)
    if (item.first.IsScalar() && item.first.Scalar() == key) return item.second;
  return absent;
}

bool YamlTable::has(const std::string& key) const { return find(key).IsDefined(); }

std::string YamlTable::first_of(std::initializer_list<const char*> keys) const {
  for (const char* key : keys)
    if (has(key)) return key;
  return *keys.begin();
}

void YamlTable::fail(const std::string& key, const std::string& what) const {
  note(find(key), key, what);
}

std::string YamlTable::text(const std::string& key) const {
  const YAML::Node node = find(key);
  if (node.IsDefined() && node.IsScalar()) return node.Scalar();
  note(node, key, node.IsDefined() ? "must be text" : "missing: add it");
  return {};
}

std::string YamlTable::text_or(const std::string& key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

std::optional<double> YamlTable::finite(const YAML::Node& node) const {
  if (!node.IsDefined() || !node.IsScalar()) return std::nullopt;
  const std::string& word = node.Scalar();
  const char* begin = word.data();
  const char* const end = begin + word.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0;
  const auto [stop, code] = std::from_chars(begin, end, value);
  if (code != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

double YamlTable::number(const std::string& key, double min, double max) const {
  const YAML::Node node = find(key);
  const auto value = finite(node);
  if (value && *value >= min && *value <= max) return *value;
  note(node, key,
       node.IsDefined() ? fmt::format("must be a number from {:g} to {:g}", min, max)
                        : "missing: add it");
  return min;
}

double YamlTable::number_or(const std::string& key, double fallback, double min, double max) const {
  return has(key) ? number(key, min, max) : fallback;
}

std::vector<double> YamlTable::numbers(const std::string& key, std::size_t min_count,
                                       std::size_t max_count) const {
  const YAML::Node node = find(key);
  const std::vector<double> nothing(min_count, 0.0);
  if (!node.IsDefined()) return note(node, key, "missing: add it"), nothing;
  if (!node.IsSequence() || node.size() < min_count || node.size() > max_count)
    return note(node, key, count_text(min_count, max_count)), nothing;
  std::vector<double> values;
  for (const auto& item : node) {
    const auto value = finite(item);
    if (!value) return note(item, key, "holds a value that is not a finite number"), nothing;
    values.push_back(*value);
  }
  return values;
}

Eigen::MatrixXd YamlTable::square_or_empty(const std::string& key, int size) const {
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return {};
  const auto bad = [&](const YAML::Node& where) {
    note(where, key, fmt::format("must be {0} rows of {0} finite numbers", size));
    return Eigen::MatrixXd();
  };
  if (!node.IsSequence() || node.size() != static_cast<std::size_t>(size)) return bad(node);
  Eigen::MatrixXd matrix(size, size);
  int r = 0;
  for (const auto& row : node) {
    if (!row.IsSequence() || row.size() != static_cast<std::size_t>(size)) return bad(row);
    int c = 0;
    for (const auto& item : row) {
      const auto value = finite(item);
      if (!value) return bad(item);
      matrix(r, c++) = *value;
    }
    ++r;
  }
  return matrix;
}

std::vector<double> YamlTable::matrix_data(const std::string& key, std::size_t min_count,
                                           std::size_t max_count) const {
  const YamlTable matrix = required_table(key);
  if (!matrix.present()) return std::vector<double>(min_count, 0.0);
  return matrix.numbers("data", min_count, max_count);
}

YamlTable YamlTable::table(const std::string& key) const {
  const YAML::Node node = find(key);
  if (node.IsDefined() && !node.IsMap()) note(node, key, "must be a mapping of keys to values");
  return {notes_, node, name_.empty() ? key : name_ + "." + key};
}

YamlTable YamlTable::required_table(const std::string& key) const {
  if (!has(key)) note(find(key), key, "missing: add it");
  return table(key);
}

Result<YamlDocument> YamlDocument::parse(const std::string& text, const std::string& name) {
  if (text.size() > kMaxBytes)
    return Error{ErrorCode::kFormat, name + ": larger than 4 MiB: give the right file"};
  YamlDocument document;
  document.notes_ = std::make_shared<YamlTable::Notes>(YamlTable::Notes{name, {}});
  try {
    document.root_ = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    return Error{ErrorCode::kFormat, fmt::format("{}:{}: not valid YAML: {}: correct the line",
                                                 name, error.mark.line + 1, error.msg)};
  }
  if (!document.root_.IsMap())
    return Error{ErrorCode::kFormat, name + ": has no keys and values: give a camera file"};
  return document;
}

Result<void> YamlDocument::finish() const {
  if (notes_->first_error) return Error{ErrorCode::kFormat, *notes_->first_error};
  return {};
}

}  // namespace mixrig::calibration_file
