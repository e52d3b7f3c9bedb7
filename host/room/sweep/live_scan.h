// SPDX-License-Identifier: Apache-2.0
// Sweeps the head of a live rig and keeps the views as a take that scan_room reads.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>

#include "hal/base/clock.h"
#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/capture/live/session/running_rig.h"
#include "host/capture/open/source_kinds.h"

namespace mixrig::session {

struct LiveScan {
  std::filesystem::path sweep, calibration;  ///< inputs of scan_room
  int views = 0, planned = 0;
  int resumed = 0;           ///< views from an earlier run
  double covered_share = 0;  ///< share of the field, by the plan; below 1 where the unit's limits
                             ///< or the number of views leave out some
  int bracketed = 0;         ///< views of this run with plates at other exposures
  int restarts = 0;          ///< frames that were shifted against those before them
  double seconds = 0;        ///< from the first move to the last view
  bool stopped = false;      ///< `stop` was set before the last view
};

struct LiveScanOptions {
  std::filesystem::path rig;          ///< rig.toml
  std::filesystem::path calibration;  ///< empty: that of rig.toml
  std::filesystem::path out;          ///< folder of the room; the sweep is written beside it
  Size field_deg{270, 180};           ///< pan x tilt
  double overlap = 0.1;
  int most_views = 0;  ///< 0: no limit; else the height of the field may be lowered
  int view_frames = 4;
  SourceKinds kinds;    ///< devices and recordings of extras, for sweep_room()
  bool bracket = true;  ///< also plates at other exposures, where a view saturates or is dark
  /// Called once before the unit moves: views, planned, resumed and covered_share are known.
  std::function<void(const LiveScan& plan)> planned;
  /// Called after each view.
  std::function<void(int done, int views, Duration left)> progress;
};

/// Folder of the sweep of a room: OUT.sweep.
std::filesystem::path sweep_folder(const std::filesystem::path& out);

/// Plans views for the depth camera's field of view within the limits of the unit, drives the unit
/// through them and writes each view when it is complete. Where the folder of the sweep holds views
/// of the same plan, rig and calibration, it continues with the next one; where all are there
/// nothing moves. After an error, or when `stop` was set, the folder is a take of the views so far.
/// Errors: kUsage for a rig without head, depth camera or calibration, for values out of range, for
/// an output that is something else or holds another plan; kFormat for a calibration that lacks the
/// unit or a camera or is of another picture size; those of the devices and of live::run_sweep;
/// kIo.
Result<LiveScan> sweep_room(const LiveScanOptions& options, const std::atomic<bool>& stop,
                            Clock& clock);
/// Sweeps with the devices of a run, which goes on. No plates at other exposures are taken, and
/// automatic settings of a camera are not held. Precondition: RunningRig::listen(true) was called.
Result<LiveScan> sweep_room_of_run(const LiveScanOptions& options, live::RunningRig& rig,
                                   const std::atomic<bool>& stop, Clock& clock);

}  // namespace mixrig::session
