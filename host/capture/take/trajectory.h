// SPDX-License-Identifier: Apache-2.0
// Poses of a take, and lists of stamped files. Private to this module.
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

/// Parses poses as geometry::parse_pose_lines() does; warns where it guesses the unit of the
/// times. Errors: kFormat (name:line: ...), also for numbers that are not finite or a quaternion
/// whose length is off 1 by over 1 %.
Result<std::vector<StampedPose>> parse_trajectory(std::string_view text, const std::string& name);

struct FileList {
  std::vector<StampedFile> files;
  std::string guessed_unit;  ///< that the times were taken in by their size; empty for seconds
};
/// Parses lines "t file". Pure. Errors: kFormat (name:line: ...).
Result<FileList> parse_file_list(std::string_view text, const std::string& name);

std::string trajectory_line(const StampedPose& pose);

/// Interpolates the pose at `time_s` in a trajectory sorted by time; nullopt outside of it, or in a
/// gap of more than `max_gap_s`.
std::optional<geometry::Pose> pose_at(const std::vector<StampedPose>& trajectory, double time_s,
                                      double max_gap_s);

}  // namespace mixrig::take
