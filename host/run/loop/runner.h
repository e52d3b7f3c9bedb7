// SPDX-License-Identifier: Apache-2.0
// The frame loop of a run. Private to this module.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "hal/base/partial_path.h"
#include "hal/base/pool.h"
#include "hal/base/work_gate.h"
#include "host/judge/baselines/baselines.h"
#include "host/judge/baselines/judge.h"
#include "host/room/background/seen_through.h"
#include "host/run/loop/capture_feed.h"
#include "host/run/loop/run.h"
#include "host/run/loop/run_compositor.h"
#include "host/run/loop/run_poses.h"
#include "host/run/session/camera_pose.h"
#include "host/run/session/quality.h"
#include "host/run/sinks/run_sinks.h"

namespace mixrig::session {

/// The state of a run; one method per step of the frame loop.
class Runner {
 public:
  Runner(Session& session, const RunOptions& options, const Clock& clock, RunParts parts)
      : session_(session),
        options_(options),
        clock_(clock),
        parts_(std::move(parts)),
        sinks_(session_, options_, clock_, gate()),
        compositor_(session_, options_, parts_.scene, parts_.orders),
        poses_(session_),
        judge_(!session.setup.backdrop) {}

  /// Learns what is not there yet, opens back end and sinks, and composites the first frame
  /// untimed.
  Result<void> prepare(FrameRange range, const ProgressFn& progress);
  /// False when the source has ended.
  Result<bool> frame();
  /// Completes the files. Errors: kData where no frame was composited.
  Result<RunReport> finish(std::string ended);
  /// Ends the sinks after an error; files with a frame stay under their partial name, which the
  /// returned error says.
  Error keep(const Error& error);
  /// Why frame() gave false.
  const std::string& ended() const { return ended_; }

 private:
  bool live() const { return session_.is_live(); }
  /// A recording has no deadline: while a frame is timed nothing is decoded or encoded beside it.
  WorkGate* gate() { return live() ? nullptr : &gate_; }
  bool judges() const { return options_.judge && session_.source->info().has_truth; }
  bool reads_truth() const {
    return judges() || (options_.true_people && session_.source->info().has_truth);
  }
  Result<void> open_compositor();
  void tell_ghosts(const capture::Capture& capture);
  pose::FramePose pose_of_first(const capture::Capture& capture);
  Result<void> warm_up(capture::CaptureItem item, const pose::FramePose& known);
  Result<void> open_baselines();
  render::OutputMask wanted(render::OutputMask by_sinks) const;
  Result<void> compose_timed(output::Composite& composite, render::OutputMask wanted);
  Result<void> inspect_and_deliver(output::Composite& composite, const capture::Truth* truth,
                                   render::OutputMask images, bool kept);
  /// Exchanges the images that only an inspection needs with the run's own.
  void swap_inspection(render::FrameOutput& images);
  Result<void> judge(output::Composite& composite, const capture::Truth& truth);
  void obey_record_orders();
  Result<void> add_last_to_sheet();

  static constexpr const char* kReportName = "report.json";

  Session& session_;
  const RunOptions& options_;
  const Clock& clock_;
  RunParts parts_;
  WorkGate gate_;
  std::optional<PartialPath> folder_;
  std::optional<QualityChoice> quality_;
  FrameReport frames_;
  RunSinks sinks_;
  RunCompositor compositor_;
  RunPoses poses_;
  HeadWatch head_;
  std::optional<model::SeenThrough> seen_through_;
  std::optional<CaptureFeed> feed_;
  Pool<output::Composite> composites_;
  Pool<output::Composite> inspected_;  ///< with inspection images that wait for a sink
  std::shared_ptr<output::Composite> last_;
  Judge judge_;
  std::optional<Baselines> baselines_;
  render::FrameOutput inspection_;  ///< images that are needed before the next frame alone
  std::string ended_ = "end of the source";
};

}  // namespace mixrig::session
