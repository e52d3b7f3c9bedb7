// SPDX-License-Identifier: Apache-2.0
// The tables of the suite, as text.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/stability/suite.h"

namespace mixrig::estimation_bench {
namespace {

std::string figures_of(const Row& r) {
  if (std::isnan(r.nees)) return "      -        -                           -    ";
  const std::string nees = fmt::format("{:6.2f} ({:4.2f}..{:4.2f})", r.nees, r.low, r.high);
  if (std::isnan(r.over_bound)) return "      -   " + nees + "              -    ";
  return fmt::format("{:7.3f}   {}        {:8.1e}  ", r.over_bound, nees, r.off_reference);
}

const char* name_of(Expect expect) {
  switch (expect) {
    case Expect::kAnswer:
      return "answer";
    case Expect::kRobust:
      return "robust";
    case Expect::kCareful:
      return "careful";
    case Expect::kRefusal:
      return "refusal";
  }
  return "";
}

/// Least and greatest of some figures.
struct Span {
  double low = INFINITY, high = -INFINITY;
  void add(double value) {
    if (std::isnan(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

std::string range_of(const Span& span, int digits) {
  if (span.low > span.high) return "-";
  return fmt::format("{:.{}f} .. {:.{}f}", span.low, digits, span.high, digits);
}

/// Results of one estimator over the cases that it must answer and those that it must refuse. Where
/// no case has a bound, the robust ones, which must be answered too, take their place.
struct Sum {
  int to_answer = 0, robust = 0, outside = 0, to_refuse = 0, refused = 0, trials = 0;
  Span over_bound, nees, micros, robust_nees, robust_micros;
  double off_reference = 0;

  void add(const Row& row) {
    if (row.expect == Expect::kRefusal) {
      ++to_refuse;
      refused += row.refused;
      trials += row.ok + row.weak + row.refused;
    }
    if (row.expect == Expect::kRobust) {
      ++robust;
      robust_nees.add(row.nees), robust_micros.add(row.micros);
    }
    if (row.expect != Expect::kAnswer) return;
    ++to_answer;
    outside += outside_95(row);
    micros.add(row.micros);
    over_bound.add(row.over_bound);
    nees.add(row.nees);
    off_reference = std::max(off_reference, row.off_reference);
  }
};

}  // namespace

std::string to_table(const Report& report) {
  std::string text =
      "estimator           case                             expected  ok/weak/refused  err/CRB  "
      "NEES/dof (95 % interval)  off 50 digits  time us\n";
  for (const Row& r : report.rows)
    text += fmt::format("{:<19} {:<32} {:<8} {:5}/{:4}/{:4}     {}{:9.1f}\n", r.estimator, r.name,
                        name_of(r.expect), r.ok, r.weak, r.refused, figures_of(r), r.micros);
  text +=
      "\nfind_marker_blobs: greatest bias over the phase, px; scatter over claimed sigma\n"
      "radius px  threshold  bias px  scatter/sigma\n";
  for (const BlobBias& b : report.blobs)
    text += fmt::format("{:9.1f}  {:9}  {:7.4f}  {:13.2f}\n", b.radius_px, b.threshold, b.bias_px,
                        b.over_sigma);
  text += fmt::format(
      "\n{} cases, {} of them to be answered; NEES outside its 95 % interval in {} (chance: up to "
      "{}); {} faults\n",
      report.rows.size(), report.answerable, report.outside, most_outside_95(report.answerable),
      report.faults.size());
  for (const std::string& fault : report.faults) text += "fault: " + fault + "\n";
  return text;
}

std::string to_summary(const Report& report) {
  std::string text =
      "| estimator | cases to answer | error / bound | NEES / dof | outside 95 % | off 50 digits, "
      "sigmas | refused where it must | time us |\n|---|---|---|---|---|---|---|---|\n";
  std::vector<std::pair<std::string, Sum>> sums;
  for (const Row& row : report.rows) {
    const auto known = std::find_if(sums.begin(), sums.end(),
                                    [&](const auto& sum) { return sum.first == row.estimator; });
    Sum& sum = known == sums.end() ? sums.emplace_back(row.estimator, Sum{}).second : known->second;
    sum.add(row);
  }
  for (const auto& [name, s] : sums) {
    const bool has_bound = s.to_answer > 0;
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} | {} of {} ({} cases) | {} |\n", name,
                        has_bound ? s.to_answer : s.robust, range_of(s.over_bound, 2),
                        range_of(has_bound ? s.nees : s.robust_nees, 2),
                        has_bound ? std::to_string(s.outside) : "-",
                        has_bound ? fmt::format("{:.0e}", s.off_reference) : "-", s.refused,
                        s.trials, s.to_refuse, range_of(has_bound ? s.micros : s.robust_micros, 0));
  }
  return text;
}

}  // namespace mixrig::estimation_bench
