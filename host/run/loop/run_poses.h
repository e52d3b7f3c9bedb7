// SPDX-License-Identifier: Apache-2.0
// The camera's pose in each frame of a run, and its report.
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
  /// `session` must outlive it.
  explicit RunPoses(const Session& session) : session_(session) {}

  /// Call it once the session's poses and background are prepared.
  void open();
  /// Sets pose and motion of the camera in a frame, and whether the frame shows its objects.
  void set(output::Composite& composite);
  /// Measures how errors of pose and lens affect the frame. `judges`: the source's true poses
  /// count; `truth`: may be null.
  void watch(output::Composite& composite, bool judges, const capture::Truth* truth);
  /// Report of the frames so far. Precondition: open() was called.
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
  std::optional<PoseErrors> error_;  ///< if true poses are known
  measure::QuantileSketch age_ms_;   ///< over frames with a pose
};

}  // namespace mixrig::session
