// SPDX-License-Identifier: Apache-2.0
// The main job: every frame of a session composited, timed, judged and written.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/app/report.h"
#include "host/app/run_writer.h"
#include "host/app/session.h"

namespace mixrig::app {

struct RunOptions {
  std::optional<std::filesystem::path> out;  ///< nothing is written where absent
  OutputOptions output;
  std::optional<FrameRange> frames;         ///< Session::default_frames where absent
  int sheet_rows = 6;                       ///< frames on the contact sheet
  const std::atomic<bool>* stop = nullptr;  ///< set it, and the run ends with what is done
  bool judge = true;                        ///< against truth, where the source has any
};

/// Prepares the background, composites the frames and writes OUT: composite/ and the other layers
/// (RunWriter), contact_sheet.png, report.json; whole or not at all. Only compose() is timed;
/// frames whose inspection images are needed are composited a second time for them, untimed.
/// Errors: kUsage for frames out of range or an OUT that is not ours; kData where a frame cannot
/// be read, or where the source ended or was stopped before the first frame; kIo; those of the
/// back end.
Result<RunReport> run(Session& session, const RunOptions& options, const Clock& clock,
                      const ProgressFn& progress);

}  // namespace mixrig::app
