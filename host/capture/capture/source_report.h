// SPDX-License-Identifier: Apache-2.0
// State of the streams of live devices, as counts since their start.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/device/camera.h"
#include "hal/device/pan_tilt.h"
#include "host/capture/sync/edge_ticks.h"
#include "host/capture/sync/pairing.h"

namespace mixrig::capture {

/// One camera's stream.
struct StreamReport {
  std::string name, uri;
  device::StreamHealth health;
  sync::PairingCounts pairing;
  double drift_ppm = 0, jitter_ms = 0;              ///< of the device's clock, if it has one
  double residual_mean_ms = 0, residual_sd_ms = 0;  ///< stamp minus tick
};

struct SourceReport {
  std::vector<StreamReport> streams;
  std::uint64_t ticks = 0, ticks_lost = 0, trigger_restarts = 0, trigger_errors = 0;
  double trigger_drift_ppm = 0;
  std::optional<sync::Tick> newest_tick;  ///< tick of the master, in host time
  sync::EdgeCounts edges;                 ///< edges of the trigger line, if this host reads one
  std::uint64_t sets = 0, incomplete_sets = 0;
  std::uint64_t waiting_events = 0;  ///< frames and ticks not paired yet
  std::uint64_t waiting_sets = 0;    ///< in the consumer's queue now
  std::uint64_t dropped_events = 0;  ///< the pairing thread was too slow
  std::uint64_t dropped_sets = 0;    ///< the consumer was too slow
  std::uint64_t pan_tilt_samples = 0, pan_tilt_errors = 0;
  std::uint64_t sets_without_angle = 0;  ///< sets without an angle although the rig has a head
  std::uint64_t left_out = 0;            ///< sets without colour or depth
  /// Captures without depth, since the depth camera was lost.
  std::uint64_t without_depth = 0;
  std::uint64_t held_depth = 0;  ///< captures that repeat the last depth
  double longest_gap_s = 0;      ///< between two captures, by their mid-exposures
  device::PanTiltHealth pan_tilt;
};

}  // namespace mixrig::capture
