// SPDX-License-Identifier: Apache-2.0
// The main job: composites and times every frame of a session, judges it and gives it to the sinks.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/output/files/files_sink.h"
#include "host/output/sink/composite_sink.h"
#include "host/run/controls/run_options.h"
#include "host/run/report/run_report.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Prepares the background, composites the frames and writes OUT (composite/, the other layers and
/// frames.csv by FilesSink, contact_sheet.png, report.json). After an error OUT.partial stays if a
/// frame was written to it; one that an earlier run left is set aside. Captures are read
/// and decoded in a thread of their own, and each sink writes in its own; the calling thread
/// composites. Only compose() is timed; frames whose inspection images are needed are composited a
/// second time for them, untimed. A live run never waits for a sink, a run of a recording does.
/// Objects with physics move before each frame, by what was seen of people up to the frame before;
/// a recording waits for that, so that the same take gives the same pictures.
/// Changes of the scene are composited from the next frames on (SceneFollower); judging ends there.
/// Memory does not grow with the number of frames. The room is watched in its own thread
/// (ChangeSink); if a folder is given, the background with accepted changes is written at the end.
/// Errors: kUsage for frames out of range, an OUT that no earlier run made, or baselines of a
/// source without truth or of a scene without baselines (Baselines::open); kData if a frame cannot
/// be read, or the source ended or was stopped before the first frame; kIo; those of the back end
/// and of the sinks.
Result<RunReport> run(Session& session, const RunOptions& options, const Clock& clock,
                      const ProgressFn& progress, RunParts parts = {});

}  // namespace mixrig::session
