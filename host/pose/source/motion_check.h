// SPDX-License-Identifier: Apache-2.0
// Rejects samples of a pose stream that cannot be poses of one moving camera.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

#include "host/capture/capture/pose_source.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::pose {

/// Fastest motion between two samples; a faster one is a jump. A pan-tilt head turns by 5 rad/s, a
/// hand by less; the constant parts cover the noise of close samples.
inline constexpr double kMostSpeed_m_s = 5.0, kMostTurn_rad_s = 10.0;
inline constexpr double kSlack_m = 0.01, kSlack_rad = 0.01;

/// Checks samples in the order of the stream. A few samples away from the others are rejected; if
/// kRun in a row agree with each other, the camera has moved there, which counts as one jump.
/// Nothing allocates. For one thread.
class MotionCheck {
 public:
  static constexpr std::size_t kRun = 3;
  enum class Verdict {
    kTake,      ///< continues the motion
    kRejected,  ///< not finite, or too far from the others
    kRestart,   ///< the camera jumped here: run() holds the samples that begin the new part
  };
  /// Checks one sample. A time before that of the last sample counts as a step of the clock; the
  /// same time again is rejected without a count.
  Verdict add(const trajectory::TimedPose& sample);
  /// Returns the kRun newest samples, including this one; valid after kRestart only.
  std::span<const trajectory::TimedPose> run() const { return {run_.data(), run_count_}; }
  const capture::PoseFaults& faults() const { return faults_; }

 private:
  Verdict begin_or_extend_run(const trajectory::TimedPose& sample);

  std::optional<trajectory::TimedPose> last_;
  std::array<trajectory::TimedPose, kRun> run_{};
  std::size_t run_count_ = 0;
  capture::PoseFaults faults_;
};

/// Whether a camera can move from a to b in the time between them, a.t_s < b.t_s.
bool is_motion(const trajectory::TimedPose& a, const trajectory::TimedPose& b);
/// Whether a sample is finite, with a rotation that is a unit quaternion to within 1 %.
bool is_finite(const trajectory::TimedPose& sample);

}  // namespace mixrig::pose
