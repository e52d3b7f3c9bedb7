// SPDX-License-Identifier: Apache-2.0
// Measures the delay of a real rig: a lamp on a trigger line blinks in view of the camera, and its
// brightness in the composites is compared with its switching times. Exact to one exposure.
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

/// Rectangle in pixels of the view.
struct MarkerRegion {
  int x = 0, y = 0, width = 0, height = 0;
};

struct MarkerOptions {
  std::filesystem::path rig{};    ///< rig.toml, whose [[trigger.line]] has the lamp
  std::filesystem::path scene{};  ///< empty: a scene with nothing in it
  std::filesystem::path folder{};
  int line = -1;          ///< trigger line of the lamp
  double exposure_s = 0;  ///< exposure time of the camera; 0: exposure_ms of rig.toml
  double duration_s = 20;
  std::optional<MarkerRegion> region{};  ///< part of the view with the lamp; absent: all of it
};

/// Brightness of the lamp and ticks of the master clock. Memory is allocated by the constructor
/// only.
struct MarkerLog {
  std::vector<sync::Tick> ticks;
  std::vector<measure::Sample> seen;     ///< mean light of the region, when the sink got it
  measure::QuantileSketch stamped_ms{};  ///< time from mid-exposure, by the stamps, to the sink
  explicit MarkerLog(std::size_t frames) { ticks.reserve(frames), seen.reserve(frames); }
};

/// Makes a sink that fills `log` until it is full. `log` outlives it; the ticks come from `source`.
std::unique_ptr<output::CompositeSink> make_marker_sink(MarkerLog& log,
                                                        std::optional<MarkerRegion> region,
                                                        const capture::CaptureSource& source,
                                                        const Clock& clock);

/// Times (host time) of a line's pulses between the first and the last tick, on and off in turn.
/// The period is that of the ticks; a master that was restarted counts from its restart on. Empty
/// for fewer than two ticks, and for a line that is off. `period`: the master's nominal period.
std::vector<double> switches_of(std::span<const sync::Tick> ticks,
                                const device::TriggerChannel& channel, Duration period);

struct MarkerReport {
  measure::Delay delay;
  double stamped_s = 0;                ///< median delay by the stamps of the same pictures
  double exposure_s = 0, blink_s = 0;  ///< exposure time, and period of the lamp
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
