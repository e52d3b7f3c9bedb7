// SPDX-License-Identifier: Apache-2.0
#include "tests/stability/suite.h"

#include <algorithm>

#include <fmt/format.h>

namespace mixrig::estimation_bench {

void add_faults(const BlobBias& blob, std::vector<std::string>& faults) {
  constexpr double kWorstBias_px = 0.02;
  if (blob.radius_px < 2 || blob.threshold > 30 || blob.bias_px <= kWorstBias_px) return;
  faults.push_back(fmt::format("find_marker_blobs, radius {:.1f} px, threshold {}: bias {:.4f} px",
                               blob.radius_px, blob.threshold, blob.bias_px));
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
  add_lamp_cases(cases);
  add_shading_cases(cases);
  add_exposure_cases(cases);
#ifdef MIXRIG_EXTRA_MAP
  add_map_place_cases(cases);
#endif
#ifdef MIXRIG_EXTRA_PEOPLE
  add_people_cases(cases);
#endif
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

}  // namespace mixrig::estimation_bench
