// SPDX-License-Identifier: Apache-2.0
// Trajectories in TUM's text format, and lists of stamped files. Private to this module.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.h"
#include "host/math/geometry/pose.h"

namespace mixrig::take {

struct StampedPose {
  double time_s = 0;
  geometry::Pose world_from_target;
};
struct StampedFile {
  double time_s = 0;
  std::string path;
};

/// Parses lines "t x y z qx qy qz qw"; '#' starts a comment. Pure. Errors: kFormat (name:line: ...)
/// for a line that is not eight finite numbers or a quaternion whose length differs from 1 by over
/// 1 %.
Result<std::vector<StampedPose>> parse_trajectory(std::string_view text, const std::string& name);
/// Parses lines "t file". Pure. Errors: kFormat (name:line: ...).
Result<std::vector<StampedFile>> parse_file_list(std::string_view text, const std::string& name);

std::string trajectory_line(const StampedPose& pose);

/// Interpolates the pose at `time_s` in a trajectory sorted by time; nullopt outside of it, or in a
/// gap of more than `max_gap_s`.
std::optional<geometry::Pose> pose_at(const std::vector<StampedPose>& trajectory, double time_s,
                                      double max_gap_s);

}  // namespace mixrig::take
