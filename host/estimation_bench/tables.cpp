// SPDX-License-Identifier: Apache-2.0
// The tables of the suite, as text.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host/estimation_bench/suite.h"

namespace mixrig::estimation_bench {
namespace {

std::string figures_of(const Row& r) {
  if (std::isnan(r.nees)) return "      -        -                           -    ";
  char line[100];
  if (std::isnan(r.over_bound))
    std::snprintf(line, sizeof line, "      -   %6.2f (%4.2f..%4.2f)              -    ", r.nees,
                  r.low, r.high);
  else
    std::snprintf(line, sizeof line, "%7.3f   %6.2f (%4.2f..%4.2f)        %8.1e  ", r.over_bound,
                  r.nees, r.low, r.high, r.off_reference);
  return line;
}

const char* name_of(Expect expect) {
  return expect == Expect::kAnswer ? "answer" : expect == Expect::kCareful ? "careful" : "refusal";
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

/// What the cases of one estimator came to that must be answered, or must be refused.
struct Sum {
  int to_answer = 0, outside = 0, to_refuse = 0, refused = 0, trials = 0;
  Span over_bound, nees, micros;
  double off_reference = 0;

  void add(const Row& row) {
    if (row.expect == Expect::kRefusal) {
      ++to_refuse;
      refused += row.refused;
      trials += row.ok + row.weak + row.refused;
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
  char line[200];
  for (const Row& r : report.rows) {
    std::snprintf(line, sizeof line, "%-19s %-32s %-8s %5d/%4d/%4d     ", r.estimator.c_str(),
                  r.name.c_str(), name_of(r.expect), r.ok, r.weak, r.refused);
    text += line + figures_of(r);
    std::snprintf(line, sizeof line, "%9.1f\n", r.micros);
    text += line;
  }
  text +=
      "\nfind_marker_blobs: greatest bias over the phase, px; scatter over claimed sigma\n"
      "radius px  threshold  bias px  scatter/sigma\n";
  for (const BlobBias& b : report.blobs) {
    std::snprintf(line, sizeof line, "%9.1f  %9d  %7.4f  %13.2f\n", b.radius_px, b.threshold,
                  b.bias_px, b.over_sigma);
    text += line;
  }
  std::snprintf(line, sizeof line,
                "\n%zu cases, %d of them to be answered; NEES outside its 95 %% interval in %d "
                "(chance: up to %d); %zu faults\n",
                report.rows.size(), report.answerable, report.outside,
                most_outside_95(report.answerable), report.faults.size());
  text += line;
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
  char line[240];
  for (const auto& [name, s] : sums) {
    std::snprintf(line, sizeof line,
                  "| `%s` | %d | %.2f .. %.2f | %.2f .. %.2f | %d | %.0e | %d of %d (%d cases) | "
                  "%.0f .. %.0f |\n",
                  name.c_str(), s.to_answer, s.over_bound.low, s.over_bound.high, s.nees.low,
                  s.nees.high, s.outside, s.off_reference, s.refused, s.trials, s.to_refuse,
                  s.micros.low, s.micros.high);
    text += line;
  }
  return text;
}

}  // namespace mixrig::estimation_bench
