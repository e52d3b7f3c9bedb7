// SPDX-License-Identifier: Apache-2.0
// Results of a suite: a row for each rung and each peer.
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
  std::string group;            ///< of the plot: "cpu", "gles", or the library of a peer
  bool peer = false;            ///< another library
  std::vector<float> times_ms;  ///< of the stages of the suite, one a frame; empty: not timed
  /// Over the pixels whose surface the ToF camera sees (CONVENTIONS.md).
  std::optional<double> bad_pct, band_bad_pct, mae_mm;
  std::optional<double> bytes;  ///< that have to be moved at least, a frame
  /// Other measures of the suite by their keys, those of CONVENTIONS.md where they are there.
  std::vector<std::pair<std::string, double>> more;
};

struct Suite {
  std::string name;
  std::string plot_key, plot_label;  ///< a key of the rows: the plot's error
  std::vector<Row> rows;
};

/// Median, 95th percentile and least time; nothing of a row that is not timed.
std::optional<double> median_ms(const Row& row);
std::optional<double> p95_ms(const Row& row);
std::optional<double> least_ms(const Row& row);

/// Array of rows: name, peer, ms, ms_p95, ms_min, bad_pct, band_bad_pct, mae_mm, bytes, copy_ms
/// (what copying as many bytes takes) and the measures of the suite. What a row does not have is
/// absent.
nlohmann::json to_json(const Suite& suite, double copy_bytes_per_s);
/// A line for each row, below a line of the keys that any row has.
std::string to_table(const Suite& suite, double copy_bytes_per_s);
/// Milliseconds against the suite's error, a colour for each group.
report::Plot plot_of(const Suite& suite);

}  // namespace mixrig::bench
