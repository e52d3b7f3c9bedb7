// SPDX-License-Identifier: Apache-2.0
// Measures the delay of a live run. A take of the studio is played in real time as the devices of a
// rig. The motion that is shown is correlated with the motion in the same pictures, composited
// beforehand, at their exposure times.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/judge/measure/delay.h"
#include "host/output/report/bars.h"
#include "host/output/sink/run_orders.h"
#include "host/output/sink/shown_log.h"
#include "host/run/loop/run.h"
#include "host/run/session/session.h"

namespace mixrig::session {

struct LatencyOptions {
  /// Take of the studio and its scene, with truth, a still camera and somebody who moves.
  std::filesystem::path scene, take;
  std::filesystem::path folder;  ///< folder for rig.toml
  std::optional<Size> view_size{};
  BackendChoice backend{};
};

/// A prepared measurement. Members point into one another, so it must not move.
struct LatencyBench {
  std::unique_ptr<Session> session;
  std::vector<measure::Sample> motion;  ///< at the times of the frames, on the host's clock
  output::ShownLog log;                 ///< filled by the sink that shows the composites
  Size view_px;
};

struct LatencyReport {
  std::size_t frames = 0;                                     ///< shown
  double period_ms = 0;                                       ///< period of the take
  std::vector<float> total_ms, wait_ms, compose_ms, show_ms;  ///< of each frame
  /// Delay by the motions alone; absent where they do not determine it.
  std::optional<measure::Delay> correlated;
  RunReport run;
};

/// Composites the take once, opens the session and reads the take into memory. Sets the time of the
/// first frame a few seconds ahead. Errors: those of scene and take; kData for a take without truth
/// or rate.
Result<std::unique_ptr<LatencyBench>> prepare_latency(const LatencyOptions& options, Clock& clock,
                                                      const std::atomic<bool>& stop);

/// Makes a sink that only fills the log with the composites it gets, where no screen is wanted.
std::unique_ptr<output::CompositeSink> make_log_sink(output::ShownLog& log, const Clock& clock);

/// Plays and composites the take; `sink` must fill bench.log. Errors: those of run(); kData where
/// nothing was shown.
Result<LatencyReport> run_latency(LatencyBench& bench, std::unique_ptr<output::CompositeSink> sink,
                                  output::RunOrders& orders, const Clock& clock);

nlohmann::json to_json(const LatencyReport& report);
std::string to_table(const LatencyReport& report);
/// Plot of medians and 99th percentiles of the stages.
report::BarPlot plot_of(const LatencyReport& report);

}  // namespace mixrig::session
