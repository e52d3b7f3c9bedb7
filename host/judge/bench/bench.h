// SPDX-License-Identifier: Apache-2.0
// Speed against error: the same walk in the studio, composited with every value of every setting.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/output/report/plot.h"
#include "host/run/report/run_report.h"
#include "host/run/session/session.h"
#include "studio/studio.h"

namespace mixrig::session {

struct BenchOptions {
  std::filesystem::path folder;  ///< takes are kept in folder/takes and used again
  bool quick = false;            ///< fewer frames, half the size
  unsigned seed = 7;
};

/// Take of the walk in the studio that is measured, in folder/takes; renders it unless it exists.
/// Errors: those of the studio.
Result<std::filesystem::path> bench_take(const BenchOptions& options, studio::RigPreset rig,
                                         const ProgressFn& progress);

/// Quality level: one setting of all parameters, and its result.
struct Rung {
  std::string knob;  ///< what is varied: "back end", "depth camera", "view size"
  std::string name;  ///< the value
  studio::RigPreset rig = studio::RigPreset::kKinect2;
  BackendChoice backend;
  Size view_size;
  RunReport report;
};

/// Renders the missing takes and runs all quality levels with their baselines, gles included where
/// it starts. A level that is one setting of several knobs is run once. Errors: those of the studio
/// and of run().
Result<std::vector<Rung>> bench(const BenchOptions& options, const Clock& clock,
                                const ProgressFn& progress);

nlohmann::json to_json(const std::vector<Rung>& rungs);
/// Text table with a row for each level, and below each depth camera a row for each baseline.
/// Shares in percent.
std::string to_table(const std::vector<Rung>& rungs);
/// Plot of milliseconds per frame against wrongly keyed pixels, a line for each knob.
report::Plot plot_of(const std::vector<Rung>& rungs);

}  // namespace mixrig::session
