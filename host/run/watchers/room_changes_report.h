// SPDX-License-Identifier: Apache-2.0
// Options and report of the watch for changes of the room, as JSON and text.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/quantile_sketch.h"
#include "host/room/changes/room_watch.h"

namespace mixrig::session {

/// Changes that a run found in the room.
struct RoomChangesReport {
  std::vector<model::RoomChange> changes;
  measure::QuantileSketch watch_ms;  ///< of one examined frame
  int accepted = 0;  ///< number of times that changes were accepted into the background
  measure::QuantileSketch learn_ms;  ///< of each acceptance, in the watching thread
  measure::QuantileSketch swap_ms;   ///< the compositing thread's part
};

struct ChangeOptions {
  bool accept_all = false;  ///< accept each change once it is certain; else by output::LearnChanges
  model::WatchOptions watch;
};

/// docs/reference/report.md has the keys.
nlohmann::json to_json(const RoomChangesReport& report);
/// One line for each change; empty if nothing changed.
std::string to_lines(const RoomChangesReport& report);

}  // namespace mixrig::session
