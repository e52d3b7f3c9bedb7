// SPDX-License-Identifier: Apache-2.0
// Reading of trajectories, declared in trajectory.h.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "hal/base/log.h"
#include "host/math/geometry/pose_lines.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::trajectory {
Result<std::vector<TimedPose>> read_samples(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code))
    return Error{ErrorCode::kNotFound, path.string() + ": no such trajectory file"};
  constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
  if (std::filesystem::file_size(path, code) > kMostBytes)
    return Error{ErrorCode::kFormat, path.string() + ": larger than " + std::to_string(kMostBytes) +
                                         " bytes: give the right file"};
  std::ifstream file(path);
  if (!file) return Error{ErrorCode::kIo, path.string() + ": cannot be opened for reading"};
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) return Error{ErrorCode::kIo, path.string() + ": reading failed"};
  MIXRIG_ASSIGN(const geometry::PoseLines lines, geometry::parse_pose_lines(text, path.string()));
  if (!lines.guessed_unit.empty())
    log_warning("trajectory", path.string() + ": times are read as " + lines.guessed_unit +
                                  ", by their size: give seconds, or a header that says the unit");
  std::vector<TimedPose> samples;
  samples.reserve(lines.poses.size());
  for (const geometry::PoseLine& line : lines.poses)
    samples.push_back({line.time_s, {line.rotation, line.position_m}});
  return samples;
}

Result<Trajectory> read_trajectory(const std::filesystem::path& path) {
  MIXRIG_ASSIGN(std::vector<TimedPose> samples, read_samples(path));
  return Trajectory(std::move(samples));
}

}  // namespace mixrig::trajectory
