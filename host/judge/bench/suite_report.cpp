// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/percentile.h"
#include "host/judge/bench/suite.h"

namespace mixrig::bench {
namespace {

using Values = std::vector<std::pair<std::string, double>>;

void add(Values& values, const char* key, std::optional<double> value, double unit = 1) {
  if (value) values.emplace_back(key, *value / unit);
}

/// All numbers of a row that are there, by their keys of the report.
Values values_of(const Row& row, double copy_bytes_per_s) {
  Values values;
  add(values, "ms", median_ms(row));
  add(values, "ms_p95", p95_ms(row));
  add(values, "ms_min", least_ms(row));
  add(values, "bad_pct", row.bad_pct);
  add(values, "band_bad_pct", row.band_bad_pct);
  add(values, "mae_mm", row.mae_mm);
  add(values, "bytes", row.bytes);
  add(values, "copy_ms", row.bytes, 1e-3 * copy_bytes_per_s);
  values.insert(values.end(), row.more.begin(), row.more.end());
  return values;
}

std::optional<double> find(const Values& values, const std::string& key) {
  const auto at =
      std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == key; });
  return at == values.end() ? std::nullopt : std::optional(at->second);
}

/// Keys that any row has, in the order of the rows.
std::vector<std::string> keys_of(const std::vector<Values>& rows) {
  std::vector<std::string> keys;
  for (const Values& row : rows)
    for (const auto& [key, value] : row)
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  return keys;
}

/// Five significant digits, without an exponent.
std::string number(double value) {
  const double size = std::abs(value);
  const int digits = size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : size >= 1 ? 3 : 5;
  return fmt::format("{:.{}f}", value, digits);
}

std::optional<double> quantile_ms(const Row& row, double q) {
  if (row.times_ms.empty()) return std::nullopt;
  return measure::quantile(row.times_ms, q);
}

}  // namespace

std::optional<double> median_ms(const Row& row) { return quantile_ms(row, 0.5); }
std::optional<double> p95_ms(const Row& row) { return quantile_ms(row, 0.95); }
std::optional<double> least_ms(const Row& row) { return quantile_ms(row, 0); }

nlohmann::json to_json(const Suite& suite, double copy_bytes_per_s) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Row& row : suite.rows) {
    nlohmann::json& out = rows.emplace_back();
    out = {{"name", row.name}, {"peer", row.peer}};
    for (const auto& [key, value] : values_of(row, copy_bytes_per_s)) out[key] = value;
  }
  return rows;
}

std::string to_table(const Suite& suite, double copy_bytes_per_s) {
  std::vector<Values> rows;
  std::size_t name_width = suite.name.size();
  for (const Row& row : suite.rows) {
    rows.push_back(values_of(row, copy_bytes_per_s));
    name_width = std::max(name_width, row.name.size() + (row.peer ? 2 : 0));
  }
  const std::vector<std::string> keys = keys_of(rows);
  std::string out = fmt::format("{:<{}}", suite.name, name_width);
  for (const std::string& key : keys)
    out += fmt::format("  {:>{}}", key, std::max<std::size_t>(key.size(), 9));
  out += "\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out += fmt::format("{:<{}}", (suite.rows[i].peer ? "* " : "") + suite.rows[i].name, name_width);
    for (const std::string& key : keys) {
      const std::optional<double> value = find(rows[i], key);
      out += fmt::format("  {:>{}}", value ? number(*value) : "-",
                         std::max<std::size_t>(key.size(), 9));
    }
    out += "\n";
  }
  return out;
}

report::Plot plot_of(const Suite& suite) {
  report::Plot plot{"mixrig bench --suite " + suite.name,
                    "milliseconds (median)",
                    suite.plot_label,
                    {},
                    true,
                    false};
  for (const Row& row : suite.rows) {
    const auto error = find(values_of(row, 1), suite.plot_key);
    const auto ms = median_ms(row);
    if (!error || !ms) continue;
    auto series = std::find_if(plot.series.begin(), plot.series.end(),
                               [&](const auto& s) { return s.name == row.group; });
    if (series == plot.series.end()) series = plot.series.insert(series, {row.group, {}});
    series->points.push_back({*ms, *error, row.name});
  }
  return plot;
}

}  // namespace mixrig::bench
