// SPDX-License-Identifier: Apache-2.0
// Time against error of a scan: one sweep, with every step of the model left out or changed in
// turn.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/output/report/plot.h"
#include "host/room/sweep/room_scan.h"
#include "host/run/loop/run.h"

namespace mixrig::session {

struct ScanBenchOptions {
  std::filesystem::path take;         ///< a sweep of the studio, with truth
  std::filesystem::path calibration;  ///< empty: the true one of the take
  int threads = 0;                    ///< 0: one per core
};

/// Quality level of a scan: one change of its options, and the result.
struct ScanRung {
  std::string knob;  ///< what is varied: "steps", "mesh", "panorama"
  std::string name;
  RoomScanOptions options;
  double cpu_seconds = 0;  ///< CPU time of all threads, from the first frame to the mesh
  RoomScan scan;           ///< without pictures and vertices
};

/// Scans the take at every level. Errors: those of scan_room.
Result<std::vector<ScanRung>> scan_bench(const ScanBenchOptions& options,
                                         const ProgressFn& progress);

nlohmann::json to_json(const std::vector<ScanRung>& rungs);
/// Text table with a row for each level.
std::string to_table(const std::vector<ScanRung>& rungs);
/// Plot of CPU seconds against the largest mean error of a length, a line for each knob.
report::Plot plot_of(const std::vector<ScanRung>& rungs);

}  // namespace mixrig::session
