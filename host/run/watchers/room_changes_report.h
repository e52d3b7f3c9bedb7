// SPDX-License-Identifier: Apache-2.0
// What a run looks for in the room, and what it found, as JSON and as lines of text.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/quantile_sketch.h"
#include "host/room/changes/room_watch.h"

namespace mixrig::session {

/// What a run found of the room.
struct RoomChangesReport {
  std::vector<model::RoomChange> changes;
  measure::QuantileSketch watch_ms;  ///< of a frame that was looked at
  int accepted = 0;                  ///< times that changes were taken into the background
  measure::QuantileSketch learn_ms;  ///< of each of them, on the watching thread
  measure::QuantileSketch swap_ms;   ///< the compositing thread's part
};

struct ChangeOptions {
  bool accept_all = false;  ///< as soon as a change is certain; else by output::LearnChanges
  model::WatchOptions watch;
};

/// docs/reference/report.md has the keys.
nlohmann::json to_json(const RoomChangesReport& report);
/// Nothing where nothing changed.
std::string to_lines(const RoomChangesReport& report);

}  // namespace mixrig::session
