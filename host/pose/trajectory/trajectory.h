// SPDX-License-Identifier: Apache-2.0
// Time-stamped poses, cleaned, and interpolated only if the samples are close enough.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "hal/base/result.h"
#include "host/math/geometry/pose.h"

namespace mixrig::trajectory {

/// One pose of a body; seconds on the recorder's own clock.
struct TimedPose {
  double t_s = 0;
  geometry::Pose world_from_body;
};

/// Poses in order of time. Immutable.
class Trajectory {
 public:
  /// Sorts by time, drops repeated times and values that are not finite.
  explicit Trajectory(std::vector<TimedPose> samples);

  const std::vector<TimedPose>& samples() const { return samples_; }
  bool empty() const { return samples_.empty(); }
  double start_s() const { return samples_.front().t_s; }
  double end_s() const { return samples_.back().t_s; }
  /// Median step between samples; 0 for fewer than two.
  double median_step_s() const { return median_step_s_; }

  /// Returns the pose at a time by cubic interpolation of the four samples around it, linear if
  /// fewer are near. nullopt outside the recording and in gaps (over 2.5 median steps).
  std::optional<geometry::Pose> at(double t_s) const;

 private:
  bool has_gap_after(std::size_t index) const;
  std::vector<TimedPose> samples_;
  double median_step_s_ = 0;
};

/// Reads TUM lines (t x y z qx qy qz qw) or CSV with these columns; '#' starts a comment, a first
/// line of words is a header. Errors: kNotFound; kFormat with file:line for a line that is neither.
Result<Trajectory> read_trajectory(const std::filesystem::path& path);
/// Reads such a file and returns its samples in the order of the file, unchecked: values may be
/// NaN. Errors: those of read_trajectory().
Result<std::vector<TimedPose>> read_samples(const std::filesystem::path& path);

}  // namespace mixrig::trajectory
