// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/motion_check.h"

#include <cmath>

namespace mixrig::pose {

using trajectory::TimedPose;

bool is_finite(const TimedPose& sample) {
  const geometry::Pose& pose = sample.world_from_body;
  return std::isfinite(sample.t_s) && pose.translation_m.allFinite() &&
         std::abs(pose.rotation.norm() - 1.0) < 0.01;  // false for NaN
}

bool is_motion(const TimedPose& a, const TimedPose& b) {
  const double dt_s = b.t_s - a.t_s;
  const geometry::Pose &from = a.world_from_body, &to = b.world_from_body;
  return (to.translation_m - from.translation_m).norm() <= kMostSpeed_m_s * dt_s + kSlack_m &&
         from.rotation.angularDistance(to.rotation) <= kMostTurn_rad_s * dt_s + kSlack_rad;
}

MotionCheck::Verdict MotionCheck::add(const TimedPose& sample) {
  if (run_count_ == kRun) run_count_ = 0;
  if (!is_finite(sample)) {
    ++faults_.not_finite;
    return Verdict::kRejected;
  }
  if (!last_) {
    last_ = sample;
    return Verdict::kTake;
  }
  if (sample.t_s == last_->t_s) return Verdict::kRejected;
  if (sample.t_s > last_->t_s && is_motion(*last_, sample)) {
    run_count_ = 0;
    last_ = sample;
    return Verdict::kTake;
  }
  return begin_or_extend_run(sample);
}

MotionCheck::Verdict MotionCheck::begin_or_extend_run(const TimedPose& sample) {
  const TimedPose& before = run_count_ > 0 ? run_[run_count_ - 1] : *last_;
  const bool extends = run_count_ > 0 && sample.t_s > before.t_s && is_motion(before, sample);
  if (!extends) {
    ++(sample.t_s < before.t_s ? faults_.clock_steps : faults_.jumps);
    run_count_ = 0;
  }
  run_[run_count_++] = sample;
  if (run_count_ < kRun) return Verdict::kRejected;
  last_ = sample;
  return Verdict::kRestart;
}

}  // namespace mixrig::pose
