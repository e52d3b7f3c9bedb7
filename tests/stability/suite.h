// SPDX-License-Identifier: Apache-2.0
// All estimators, well posed and near their degeneracies: cases, measures, tables and plots.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/stability/case.h"

namespace mixrig::estimation_bench {

void add_rigid_fit_cases(std::vector<Case>& cases);
void add_multilateration_cases(std::vector<Case>& cases);
void add_triangulation_cases(std::vector<Case>& cases);
void add_pnp_cases(std::vector<Case>& cases);
void add_plane_fit_cases(std::vector<Case>& cases);
void add_hand_eye_cases(std::vector<Case>& cases);
void add_pan_tilt_cases(std::vector<Case>& cases);
void add_constellation_cases(std::vector<Case>& cases);
void add_lamp_cases(std::vector<Case>& cases);
void add_shading_cases(std::vector<Case>& cases);
void add_exposure_cases(std::vector<Case>& cases);
void add_map_place_cases(std::vector<Case>& cases);  ///< of the extra "map"
void add_people_cases(std::vector<Case>& cases);     ///< of the extra "people"
/// Cases of all estimators.
std::vector<Case> all_cases();

/// Bias of marker centres over the phase within a pixel, for one radius and threshold.
struct BlobBias {
  double radius_px = 0;
  int threshold = 0;
  double bias_px = 0;     ///< greatest over ten phases, mean of `shots` pictures each
  double over_sigma = 0;  ///< scatter in x over the claimed sigma
};
std::vector<BlobBias> measure_blob_bias(int shots);
/// Adds a fault where the bias exceeds 0.02 px, for radii from 2 px on and a threshold a tenth of
/// the peak above the background.
void add_faults(const BlobBias& blob, std::vector<std::string>& faults);

struct Report {
  std::vector<Row> rows;
  std::vector<BlobBias> blobs;
  std::vector<std::string> faults;
  int answerable = 0;  ///< cases that must be answered
  int outside = 0;     ///< answerable cases whose NEES lies outside its 95 % interval
};
/// Runs everything; `progress(done, total)` may be empty.
Report run_suite(const Effort& effort, const std::function<void(int, int)>& progress = {});

/// The tables that `estimation_bench` prints.
std::string to_table(const Report& report);
/// One line an estimator, as Markdown: the table of docs/results/estimation.md.
std::string to_summary(const Report& report);
/// Error over the bound, NEES and verdicts along every sweep into a degeneracy, as SVG.
std::string sweeps_svg(const Report& report);

}  // namespace mixrig::estimation_bench
