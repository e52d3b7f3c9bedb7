// SPDX-License-Identifier: Apache-2.0
// Results of a suite: a row for each quality level and each peer.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/output/report/plot.h"

namespace mixrig::bench {

struct Row {
  std::string name;
  std::string group;            ///< group in the plot: "cpu", "gles", or the library of a peer
  bool peer = false;            ///< another library
  std::vector<float> times_ms;  ///< time of the suite's stages in each frame; empty: not timed
  /// Depth errors over the pixels whose surface the ToF camera sees (docs/reference/measures.md).
  std::optional<double> bad_pct, band_bad_pct, mae_mm;
  std::optional<double> bytes;  ///< bytes that each frame must read and write
  /// Other measures of the suite by their keys; those that docs/reference/measures.md defines have
  /// its keys.
  std::vector<std::pair<std::string, double>> more;
};

struct Suite {
  std::string name;
  std::string plot_key, plot_label;  ///< key of the rows that is the plot's error, and its label
  std::vector<Row> rows;
};

/// Median, 95th percentile and least time; nullopt for a row that is not timed.
std::optional<double> median_ms(const Row& row);
std::optional<double> p95_ms(const Row& row);
std::optional<double> least_ms(const Row& row);

/// Array of rows: name, peer, ms, ms_p95, ms_min, bad_pct, band_bad_pct, mae_mm, bytes, copy_ms
/// (time that copying as many bytes takes) and the measures of the suite. Keys without a value are
/// absent.
nlohmann::json to_json(const Suite& suite, double copy_bytes_per_s);
/// Text table: a line with the keys that any row has, then a line for each row.
std::string to_table(const Suite& suite, double copy_bytes_per_s);
/// Plot of milliseconds against the suite's error, a colour for each group.
report::Plot plot_of(const Suite& suite);

}  // namespace mixrig::bench
