// SPDX-License-Identifier: Apache-2.0
#include "host/estimation_bench/suite.h"

#include <algorithm>
#include <cstdio>

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

}  // namespace

void add_faults(const BlobBias& blob, std::vector<std::string>& faults) {
  constexpr double kWorstBias_px = 0.02;
  if (blob.radius_px < 2 || blob.threshold > 30 || blob.bias_px <= kWorstBias_px) return;
  char line[120];
  std::snprintf(line, sizeof line, "find_marker_blobs, radius %.1f px, threshold %d: bias %.4f px",
                blob.radius_px, blob.threshold, blob.bias_px);
  faults.push_back(line);
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  add_rigid_fit_cases(cases);
  add_multilateration_cases(cases);
  add_triangulation_cases(cases);
  add_pnp_cases(cases);
  add_plane_fit_cases(cases);
  add_hand_eye_cases(cases);
  add_pan_tilt_cases(cases);
  add_constellation_cases(cases);
  return cases;
}

Report run_suite(const Effort& effort, const std::function<void(int, int)>& progress) {
  Report report;
  const std::vector<Case> cases = all_cases();
  for (const Case& c : cases) {
    const Row row = measure(c, effort);
    for (auto& fault : faults_of(row)) report.faults.push_back(std::move(fault));
    report.answerable += row.expect == Expect::kAnswer;
    report.outside += outside_95(row);
    report.rows.push_back(row);
    if (progress) progress(static_cast<int>(report.rows.size()), static_cast<int>(cases.size()));
  }
  const int most = most_outside_95(report.answerable);
  if (report.outside > most)
    report.faults.push_back("NEES of " + std::to_string(report.outside) +
                            " cases lies outside its 95 % interval; chance explains " +
                            std::to_string(most));
  report.blobs = measure_blob_bias(std::max(50, effort.trials));
  for (const BlobBias& blob : report.blobs) add_faults(blob, report.faults);
  return report;
}

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

}  // namespace mixrig::estimation_bench
