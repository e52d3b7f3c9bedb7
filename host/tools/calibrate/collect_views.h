// SPDX-License-Identifier: Apache-2.0
// Work of `mixrig calibrate views`, with a source of captures or with a pan-tilt unit.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "hal/base/clock.h"
#include "host/calibrate/views/view_collector.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::tools {

struct CollectArguments {
  std::filesystem::path out;
  calibration::CollectSettings settings;
  int turn_views = 20;
  Size turn_deg;  ///< pan x tilt from side to side; empty: as far as the board stays in the picture
};

/// Takes views until they cover everything that is wanted, the source ends or `stop` is set, and
/// writes them. Errors: kData where there is no view; those of the source, after the views so far
/// were written.
Result<nlohmann::json> collect_views(capture::CaptureSource& source,
                                     const CollectArguments& arguments,
                                     const std::atomic<bool>& stop);

/// Turns the pan-tilt unit of a rig before a board that stands still, taking views, and returns to
/// where it began. Errors: kUsage for a rig without a unit; kData where the board is not seen;
/// those of the devices and of the sweep, after the views so far were written.
Result<nlohmann::json> turn_views(const std::filesystem::path& rig,
                                  const CollectArguments& arguments, const std::atomic<bool>& stop,
                                  Clock& clock);

/// Shows the progress: a line that is rewritten where stderr is a terminal (with its bell when a
/// view is kept), else a line for each kept view.
class CollectStatus {
 public:
  CollectStatus();
  ~CollectStatus();
  void show(calibration::CollectState state, const calibration::ViewCollector& collector);

 private:
  bool terminal_;
  bool moved_ = true;  ///< the board moved since the last bell
};

/// Writes coverage.png and the views. `error`: the error that ended it early, or null; it is
/// returned with the number of views once these are written. `ended`: a word that says how it
/// ended. Errors: kData where there is no view; kIo.
Result<nlohmann::json> finish_views(calibration::ViewCollector& collector,
                                    const CollectArguments& arguments, const char* ended,
                                    const Error* error);

}  // namespace mixrig::tools
