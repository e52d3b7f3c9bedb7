// SPDX-License-Identifier: Apache-2.0
// The delay of a real rig: a lamp on a trigger line, seen by the camera, and its brightness in the
// composites at the times when they are there. Exact to one exposure.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/clock.h"
#include "hal/base/quantile_sketch.h"
#include "hal/base/result.h"
#include "hal/device/trigger.h"
#include "host/capture/capture/capture_source.h"
#include "host/capture/sync/pairing.h"
#include "host/judge/measure/delay.h"
#include "host/output/sink/composite_sink.h"

namespace mixrig::session {

/// Pixels of the view.
struct MarkerRegion {
  int x = 0, y = 0, width = 0, height = 0;
};

struct MarkerOptions {
  std::filesystem::path rig{};    ///< rig.toml, whose [[trigger.line]] has the lamp
  std::filesystem::path scene{};  ///< empty: a scene with nothing in it
  std::filesystem::path folder{};
  int line = -1;          ///< of the lamp
  double exposure_s = 0;  ///< of the camera; 0: exposure_ms of rig.toml
  double duration_s = 20;
  std::optional<MarkerRegion> region{};  ///< of the view that shows the lamp; all of it if absent
};

/// What was seen and when the master ticked. Memory is made by the constructor.
struct MarkerLog {
  std::vector<sync::Tick> ticks;
  std::vector<measure::Sample> seen;     ///< mean light of the region, at the time of the sink
  measure::QuantileSketch stamped_ms{};  ///< from the stamps of mid-exposure to the sink
  explicit MarkerLog(std::size_t frames) { ticks.reserve(frames), seen.reserve(frames); }
};

/// Fills a log that outlives it, as long as it has room. The source tells the ticks.
std::unique_ptr<output::CompositeSink> make_marker_sink(MarkerLog& log,
                                                        std::optional<MarkerRegion> region,
                                                        const capture::CaptureSource& source,
                                                        const Clock& clock);

/// Times of a line's pulses between the first and the last tick, on and off in turn, on host time.
/// The master's period is that of the ticks. A master that was restarted counts from there on.
/// Empty for fewer than two ticks, and a line that is off. `period`: nominal, of the master.
std::vector<double> switches_of(std::span<const sync::Tick> ticks,
                                const device::TriggerChannel& channel, Duration period);

struct MarkerReport {
  measure::Delay delay;
  double stamped_s = 0;                ///< median by the stamps of the same pictures
  double exposure_s = 0, blink_s = 0;  ///< period of the lamp
  std::size_t frames = 0, switches = 0;
};

/// Runs the rig for `duration_s`. Errors: kUsage for a line that the rig does not have, or whose
/// lamp is lit or dark for less than the exposure, or blinks more often than twice a second; kData
/// where the lamp is not seen to blink; those of scene, rig and run().
Result<MarkerReport> measure_marker(const MarkerOptions& options, Clock& clock,
                                    const std::atomic<bool>& stop);

nlohmann::json to_json(const MarkerReport& report);
std::string to_table(const MarkerReport& report);

}  // namespace mixrig::session
