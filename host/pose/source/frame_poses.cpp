// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/frame_poses.h"

#include <numeric>

#include "host/pose/source/motion_check.h"

namespace mixrig::pose {

using capture::CameraPose;
using capture::PoseLoss;

std::uint64_t FramePoseCounts::lost() const {
  return std::accumulate(frames.begin() + 1, frames.end(), std::uint64_t{0});
}

CameraPose FramePoses::checked(const capture::Capture& capture) {
  CameraPose pose = source_.pose_of(capture);
  if (!pose.ok()) return pose;
  if (!is_finite({pose.age_s, pose.world_from_target}))
    return CameraPose::lost(PoseLoss::kNotFinite);
  if (pose.age_s > options_.max_age_s) return CameraPose::lost(PoseLoss::kTooOld);
  return pose;
}

FramePose FramePoses::next(const capture::Capture& capture) {
  FramePose frame{checked(capture), true};
  CameraPose& pose = frame.camera;
  ++counts_.frames[static_cast<std::size_t>(pose.loss)];
  if (!pose.ok()) {
    if (last_) pose.world_from_target = last_->world_from_body;
    frame.objects_shown = last_.has_value() && options_.when_lost == WhenLost::kFreeze;
    return frame;
  }
  const trajectory::TimedPose now{capture.time_s, pose.world_from_target};
  if (last_ && now.t_s > last_->t_s && !is_motion(*last_, now)) ++counts_.jumps;
  last_ = now;
  return frame;
}

}  // namespace mixrig::pose
