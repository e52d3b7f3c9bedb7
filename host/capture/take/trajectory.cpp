// SPDX-License-Identifier: Apache-2.0
// Text files of poses and of stamped pictures.
#include "host/capture/take/trajectory.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "host/capture/take/tell_once.h"
#include "host/math/geometry/pose_lines.h"
#include "host/math/geometry/stamp_unit.h"

namespace mixrig::take {
namespace {

constexpr std::string_view kBlank = " \t\r,";

/// Removes the first word of `line` and returns it; empty at its end.
std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  return word;
}

std::optional<double> to_number(std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// Calls use(line) for each line that is not blank; a line for which it returns false is an error.
template <typename Use>
Result<void> each_line(std::string_view text, const std::string& name, const char* wanted,
                       Use use) {
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    const std::size_t start = line.find_first_not_of(kBlank);
    if (start == std::string_view::npos || line[start] == '#') continue;
    if (!use(line))
      return Error{ErrorCode::kFormat, name + ":" + std::to_string(number) + ": the line must be " +
                                           wanted + ": correct it"};
  }
  return {};
}

}  // namespace

Result<std::vector<StampedPose>> parse_trajectory(std::string_view text, const std::string& name) {
  MIXRIG_ASSIGN(const geometry::PoseLines lines, geometry::parse_pose_lines(text, name));
  if (!lines.guessed_unit.empty())
    tell_once(name + ": times are read as " + lines.guessed_unit +
              ", by their size: give seconds, or a header that says the unit");
  std::vector<StampedPose> poses;
  poses.reserve(lines.poses.size());
  for (const geometry::PoseLine& line : lines.poses) {
    const bool finite = std::isfinite(line.time_s) && line.position_m.allFinite();
    if (!finite || !(std::abs(line.rotation.norm() - 1.0) <= 0.01))
      return Error{ErrorCode::kFormat,
                   name + ":" + std::to_string(line.line) +
                       ": t x y z must be finite and qx qy qz qw of length 1: correct the line"};
    poses.push_back({line.time_s, {line.rotation.normalized(), line.position_m}});
  }
  return poses;
}

Result<FileList> parse_file_list(std::string_view text, const std::string& name) {
  FileList list;
  geometry::StampUnit unit;
  const auto use = [&](std::string_view line) {
    const auto time = to_number(next_word(line));
    const std::string_view path = next_word(line);
    if (!time || path.empty()) return false;
    if (list.files.empty()) unit = geometry::unit_of_stamp(*time);
    list.files.push_back({*time * unit.seconds, std::string(path)});
    return true;
  };
  MIXRIG_TRY(each_line(text, name, "a time and a file name", use));
  if (unit.seconds != 1) list.guessed_unit = unit.name;
  return list;
}

std::string trajectory_line(const StampedPose& pose) {
  const auto& t = pose.world_from_target.translation_m;
  const auto& q = pose.world_from_target.rotation;
  std::string line;
  for (const double value : {pose.time_s, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
    line += (line.empty() ? "" : " ") + std::string(text, end);
  }
  return line + "\n";
}

std::optional<geometry::Pose> pose_at(const std::vector<StampedPose>& trajectory, double time_s,
                                      double max_gap_s) {
  const auto earlier = [](const StampedPose& pose, double t) { return pose.time_s < t; };
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), time_s, earlier);
  if (after == trajectory.end()) return std::nullopt;
  if (after->time_s == time_s) return after->world_from_target;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = after - 1;
  const double gap_s = after->time_s - before->time_s;
  if (gap_s > max_gap_s) return std::nullopt;
  const double part = (time_s - before->time_s) / gap_s;
  const geometry::Pose &a = before->world_from_target, &b = after->world_from_target;
  return geometry::Pose{a.rotation.slerp(part, b.rotation).normalized(),
                        (1 - part) * a.translation_m + part * b.translation_m};
}

}  // namespace mixrig::take
