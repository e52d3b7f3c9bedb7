// SPDX-License-Identifier: Apache-2.0
// The camera's pose in each frame of a run, and what is reported of it.
#pragma once

#include <optional>

#include "host/judge/baselines/slip.h"
#include "host/output/sink/composite_sink.h"
#include "host/pose/source/frame_poses.h"
#include "host/room/background/frame_lens.h"
#include "host/run/loop/plate_motion.h"
#include "host/run/report/run_report.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// For the compositing thread of one run.
class RunPoses {
 public:
  /// `session` outlives it.
  explicit RunPoses(const Session& session) : session_(session) {}

  /// Once the session's poses and background are prepared.
  void open();
  /// Pose and motion of the camera in a frame, and whether it shows its objects.
  void set(output::Composite& composite);
  /// What errors of the pose and of the lens do to the frame. `judges`: the source has true poses
  /// that count; `truth`: null where there is none.
  void watch(output::Composite& composite, bool judges, const capture::Truth* truth);
  /// After open(): of the frames so far.
  PoseReport report() const;

 private:
  void watch_slip(output::Composite& composite, bool judges, const capture::Truth* truth);
  void watch_camera(const geometry::Pose& world_from_target);

  const Session& session_;
  std::optional<pose::FramePoses> poses_;
  PlateMotion motion_;
  std::optional<SlipWatch> slip_;
  std::optional<LensWatch> lens_;
  std::optional<geometry::Pose> first_pose_;
  bool warned_ = false, warned_lost_ = false;
  std::optional<PoseErrors> error_;  ///< where the true poses are known
  measure::QuantileSketch age_ms_;   ///< of frames with a pose
};

}  // namespace mixrig::session
