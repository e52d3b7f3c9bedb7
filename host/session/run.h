// SPDX-License-Identifier: Apache-2.0
// The main job: every frame of a session composited, timed, judged and given to the sinks.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/output/composite_sink.h"
#include "host/output/files_sink.h"
#include "host/output/run_controls.h"
#include "host/session/run_report.h"
#include "host/session/scene_follower.h"
#include "host/session/session.h"

namespace mixrig::session {

struct RunOptions {
  std::optional<std::filesystem::path> out;  ///< no files where absent
  output::OutputOptions output;
  std::optional<FrameRange> frames;         ///< Session::default_frames where absent
  int sheet_rows = 6;                       ///< frames on the contact sheet
  const std::atomic<bool>* stop = nullptr;  ///< when set, the run ends with the frames done so far
  bool judge = true;                        ///< against truth, where the source has any
  bool true_people = false;                 ///< sinks get their places, where the source has them
  /// Whether they are followed, and what they touch is told; absent: as the scene says.
  std::optional<bool> follow_people;
  /// Of 1970, at host time 0: poses are sent to the programs that the scene names.
  std::optional<std::int64_t> epoch_ns;
  std::vector<scene::StreamOut> streams;  ///< in addition to those of the scene
  bool baselines = false;                 ///< judge plain composites beside it
  /// For changes, where the background can be watched; absent: in live runs.
  std::optional<bool> watch_room;
  ChangeOptions changes;  ///< which of them become background
  /// Whose changes of the scene are composited; null: a live run makes its own.
  std::shared_ptr<SceneFollower> scene;
  std::optional<std::filesystem::path> save_room;  ///< where the background with them is written
  output::RunControls* controls = nullptr;         ///< by an operator; null: nobody
  std::vector<std::unique_ptr<output::CompositeSink>> sinks;  ///< in addition to those of `out`
};

/// Prepares the background, composites the frames and writes OUT: composite/, the other layers and
/// frames.csv (FilesSink), contact_sheet.png, report.json; either all of OUT or nothing.
/// Captures are read and decoded in a thread of their own, each sink writes in its own; this thread
/// composites. Only compose() is timed; frames whose inspection images are needed are composited a
/// second time for them, untimed. A live run never waits for a sink, a run of a recording does.
/// Objects with physics move before each frame, by what was seen of people up to the frame before;
/// a recording waits for that, so that the same take gives the same pictures.
/// Changes of the scene are composited from the next frames on (SceneFollower); a run that is
/// judged is judged until then. Memory does not grow with the number of frames. The room is watched
/// in a thread of its own (ChangeSink); the background that changes were accepted into is written
/// at the end, if there is one.
/// Errors: kUsage for frames out of range, an OUT that no earlier run made, or baselines of a
/// source without truth or of a scene that has none (Baselines::open); kData where a frame cannot
/// be read, or where the source ended or was stopped before the first frame; kIo; those of the back
/// end and of the sinks.
Result<RunReport> run(Session& session, RunOptions options, const Clock& clock,
                      const ProgressFn& progress);

}  // namespace mixrig::session
