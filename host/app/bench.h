// SPDX-License-Identifier: Apache-2.0
// Speed against error: the same walk in the studio, composited on every rung of every knob.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/app/plot.h"
#include "host/app/report.h"
#include "host/app/session.h"
#include "host/studio/studio.h"

namespace mixrig::app {

struct BenchOptions {
  std::filesystem::path folder;  ///< takes are kept in folder/takes and used again
  bool quick = false;            ///< fewer frames, half the size
  unsigned seed = 7;
};

/// One setting of all knobs, and what it gave.
struct Rung {
  std::string knob;  ///< what is varied: "back end", "depth camera", "view size"
  std::string name;  ///< the setting
  studio::RigPreset rig = studio::RigPreset::kKinect2;
  BackendChoice backend;
  Size view_size;
  RunReport report;
};

/// Renders the takes that are missing and runs all rungs, gles among them where it starts. A rung
/// that is one setting of several knobs is run once. Errors: those of the studio and of run().
Result<std::vector<Rung>> bench(const BenchOptions& options, const Clock& clock,
                                const ProgressFn& progress);

nlohmann::json to_json(const std::vector<Rung>& rungs);
std::string to_table(const std::vector<Rung>& rungs);
/// Milliseconds a frame against wrongly keyed pixels, a line for each knob.
Plot plot_of(const std::vector<Rung>& rungs);

}  // namespace mixrig::app
