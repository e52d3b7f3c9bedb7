// SPDX-License-Identifier: Apache-2.0
// Reading of trajectories, declared in trajectory.h.
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "host/pose/trajectory/trajectory.h"

namespace mixrig::trajectory {
namespace {

/// Parses the eight numbers of a line, separated by spaces, tabs, commas or semicolons.
std::optional<TimedPose> parse_line(std::string_view line) {
  std::array<double, 8> v{};
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto skip = [&] {
    while (at != end && (*at == ' ' || *at == '\t' || *at == ',' || *at == ';' || *at == '\r'))
      ++at;
  };
  for (double& value : v) {
    skip();
    const auto [next, code] = std::from_chars(at, end, value);
    if (code != std::errc() || next == at) return std::nullopt;
    at = next;
  }
  skip();
  if (at != end) return std::nullopt;
  return TimedPose{v[0], {Eigen::Quaterniond(v[7], v[4], v[5], v[6]), {v[1], v[2], v[3]}}};
}

bool is_skipped(std::string_view line) {
  const auto first = line.find_first_not_of(" \t\r,");
  return first == std::string_view::npos || line[first] == '#';
}

/// Whether a line is a header of column names: it starts with a letter.
bool is_header(std::string_view line) {
  const auto first = line.find_first_not_of(" \t\"");
  return first != std::string_view::npos &&
         std::isalpha(static_cast<unsigned char>(line[first])) != 0;
}

}  // namespace

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
  std::vector<TimedPose> samples;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (is_skipped(line) || (samples.empty() && is_header(line))) continue;
    const auto sample = parse_line(line);
    if (!sample)
      return Error{ErrorCode::kFormat, path.string() + ":" + std::to_string(number) +
                                           ": expected t x y z qx qy qz qw (TUM or CSV)"};
    samples.push_back(*sample);
  }
  if (file.bad()) return Error{ErrorCode::kIo, path.string() + ": reading failed"};
  return samples;
}

Result<Trajectory> read_trajectory(const std::filesystem::path& path) {
  MIXRIG_ASSIGN(std::vector<TimedPose> samples, read_samples(path));
  return Trajectory(std::move(samples));
}

}  // namespace mixrig::trajectory
