// SPDX-License-Identifier: Apache-2.0
// Typed getters over the parsed tree; they note what is wrong and return a default.
#include "host/math/config/table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/math/config/document_state.h"

namespace mixrig::config {
namespace {

std::optional<double> number_of(const Node& node) {
  if (const auto* integer = std::get_if<long long>(&node.value))
    return static_cast<double>(*integer);
  if (const auto* number = std::get_if<double>(&node.value)) return *number;
  return std::nullopt;
}

}  // namespace

bool Table::has(std::string_view key) const {
  document_->state_->known[node_].emplace(key);
  return node_ != nullptr && node_->find(key) != nullptr;
}

bool Table::is_number(std::string_view key) const {
  const Node* node = find(key, false);
  return node != nullptr && number_of(*node).has_value();
}

std::vector<std::string> Table::keys() const {
  return node_ != nullptr ? node_->keys : std::vector<std::string>();
}

std::size_t Table::size_of(std::string_view key) const {
  const Node* node = find(key, false);
  return node != nullptr && node->kind == Node::Kind::kArray ? node->items.size() : 0;
}

const Node* Table::find(std::string_view key, bool required) const {
  document_->state_->known[node_].emplace(key);
  const Node* node = node_ != nullptr ? node_->find(key) : nullptr;
  if (node == nullptr && required && node_ != nullptr) fail(key, "missing: add it");
  return node;
}

void Table::fail(std::string_view key, const std::string& what) const {
  const Node* node = node_ != nullptr ? node_->find(key) : nullptr;
  if (node == nullptr) node = node_;
  document_->state_->note(node != nullptr ? node->line : 1, dotted(name_, key), what);
}

void Table::fail(std::string_view key, const Error& error) const { fail(key, to_line(error)); }

void Table::wrong_type(std::string_view key, std::string_view wanted) const {
  fail(key, fmt::format("must be {}: correct the value", wanted));
}

bool Table::check(std::string_view key, double value, Range range) const {
  if (std::isfinite(value) && value >= range.min && value <= range.max) return true;
  fail(key,
       fmt::format("{:.6g} is out of range: give {:.6g} to {:.6g}", value, range.min, range.max));
  return false;
}

double Table::number(std::string_view key, Range range) const {
  const Node* node = find(key, true);
  return node != nullptr ? number_or(key, range.min, range) : range.min;
}

double Table::number_or(std::string_view key, double fallback, Range range) const {
  const Node* node = find(key, false);
  if (node == nullptr) return fallback;
  const auto value = number_of(*node);
  if (!value) return wrong_type(key, "a number"), fallback;
  return check(key, *value, range) ? *value : fallback;
}

int Table::integer(std::string_view key, Range range) const {
  const Node* node = find(key, true);
  const int fallback = static_cast<int>(range.min);
  return node != nullptr ? integer_or(key, fallback, range) : fallback;
}

int Table::integer_or(std::string_view key, int fallback, Range range) const {
  const Node* node = find(key, false);
  if (node == nullptr) return fallback;
  const auto* value = std::get_if<long long>(&node->value);
  if (value == nullptr) return wrong_type(key, "a whole number"), fallback;
  return check(key, static_cast<double>(*value), range) ? static_cast<int>(*value) : fallback;
}

bool Table::boolean_or(std::string_view key, bool fallback) const {
  const Node* node = find(key, false);
  if (node == nullptr) return fallback;
  const auto* value = std::get_if<bool>(&node->value);
  if (value == nullptr) return wrong_type(key, "true or false"), fallback;
  return *value;
}

std::string Table::text(std::string_view key) const {
  return find(key, true) != nullptr ? text_or(key, "") : "";
}

std::string Table::text_or(std::string_view key, std::string_view fallback) const {
  const Node* node = find(key, false);
  if (node == nullptr) return std::string(fallback);
  const auto* value = std::get_if<std::string>(&node->value);
  if (value == nullptr || value->find('\0') != std::string::npos)
    return wrong_type(key, "a text in quotes"), std::string(fallback);
  return *value;
}

int Table::one_of(std::string_view key, const std::vector<std::string>& words, int fallback) const {
  const std::string word = text_or(key, words[static_cast<std::size_t>(fallback)]);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found != words.end()) return static_cast<int>(found - words.begin());
  std::string list;
  for (const std::string& known : words) list += (list.empty() ? "\"" : ", \"") + known + "\"";
  fail(key, "\"" + word + "\" is not known: use one of " + list);
  return fallback;
}

std::vector<double> Table::numbers(std::string_view key, std::size_t min_count,
                                   std::size_t max_count, Range range) const {
  std::vector<double> values(min_count, range.min > 0 ? range.min : 0.0);
  const Node* node = find(key, true);
  if (node == nullptr) return values;
  if (const auto single = number_of(*node); single && min_count == 1)
    return check(key, *single, range) ? std::vector{*single} : values;
  const std::string wanted =
      min_count == max_count ? fmt::format("an array of {} numbers", min_count)
                             : fmt::format("an array of {} to {} numbers", min_count, max_count);
  const std::size_t size = node->items.size();
  if (node->kind != Node::Kind::kArray || size < min_count || size > max_count)
    return wrong_type(key, wanted), values;
  std::vector<double> read;
  for (const Node& item : node->items) {
    const auto value = number_of(item);
    if (!value) return wrong_type(key, wanted), values;
    if (!check(key, *value, range)) return values;
    read.push_back(*value);
  }
  return read;
}

std::vector<double> Table::matrix(std::string_view key, std::size_t rows,
                                  std::size_t columns) const {
  std::vector<double> values;
  const Node* node = find(key, true);
  const bool right_rows =
      node != nullptr && node->kind == Node::Kind::kArray && node->items.size() == rows;
  for (std::size_t row = 0; right_rows && row < rows; ++row)
    for (const Node& item : node->items[row].items)
      if (const auto value = number_of(item); value && node->items[row].items.size() == columns)
        values.push_back(*value);
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (values.size() == rows * columns && finite) return values;
  if (node != nullptr) {
    wrong_type(key,
               fmt::format("{} arrays of {} {}numbers", rows, columns, finite ? "" : "finite "));
  }
  return std::vector<double>(rows * columns, 0.0);
}

Table Table::child(std::string_view key, const Node* node) const {
  if (node != nullptr) document_->state_->known.try_emplace(node);
  return {document_, node, dotted(name_, key)};
}

Table Table::table(std::string_view key) const {
  const Node* node = find(key, false);
  if (node != nullptr && node->kind != Node::Kind::kTable) {
    wrong_type(key, "a table");
    node = nullptr;
  }
  return child(key, node);
}

Table Table::required_table(std::string_view key) const {
  find(key, true);
  return table(key);
}

std::vector<Table> Table::tables(std::string_view key) const {
  std::vector<Table> list;
  const Node* node = find(key, false);
  if (node == nullptr) return list;
  const auto is_table = [](const Node& item) { return item.kind == Node::Kind::kTable; };
  if (node->kind != Node::Kind::kArray ||
      !std::all_of(node->items.begin(), node->items.end(), is_table)) {
    fail(key, "must be tables: write [[" + dotted(name_, key) + "]] before each");
    return list;
  }
  for (const Node& item : node->items) list.push_back(child(key, &item));
  return list;
}

}  // namespace mixrig::config
