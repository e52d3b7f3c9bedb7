// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/frame_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace mixrig::take {
namespace {

/// No camera's pictures are farther apart; those of time-lapse are, and get a warning.
constexpr double kLongestStep_s = 5;

/// The median step of a list's times; 0 for fewer than two.
double median_step_s(const std::vector<StampedFile>& files) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < files.size(); ++i)
    steps.push_back(std::abs(files[i].time_s - files[i - 1].time_s));
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// The unit in which this step would be that of a camera; null where it is one in seconds.
const char* seeming_unit(double step) {
  if (step >= 5e6) return "nanoseconds";
  if (step >= 5e3) return "microseconds";
  return step >= kLongestStep_s ? "milliseconds" : nullptr;
}

std::string unit_hint(double step_s) {
  const char* unit = seeming_unit(step_s);
  if (unit == nullptr) return "times are seconds on one clock: check both lists";
  return fmt::format("times are seconds (these look like {}): convert them", unit);
}

}  // namespace

bool rates_differ(const StreamInfo& a, const StreamInfo& b) {
  return a.rate_hz > 0 && b.rate_hz > 0 && a.rate_hz != b.rate_hz;
}

std::vector<PicturePair> pair_numbered(const StreamInfo& color, const StreamInfo& depth,
                                       bool by_number) {
  std::vector<PicturePair> pairs;
  if (by_number || !rates_differ(color, depth)) {
    for (int i = 0; i < std::min(color.count, depth.count); ++i)
      pairs.push_back({i, i, depth.delay_s});
    return pairs;
  }
  const bool color_is_slower = color.rate_hz < depth.rate_hz;
  const StreamInfo& slow = color_is_slower ? color : depth;
  const StreamInfo& fast = color_is_slower ? depth : color;
  // Of a picture of the slow stream, in seconds after the first one of the fast.
  const double shift_s = color_is_slower ? -depth.delay_s : depth.delay_s;
  for (int i = 0; i < slow.count; ++i) {
    constexpr double kTie = 1e-6;  // between two, the earlier
    const double place = (i / slow.rate_hz + shift_s) * fast.rate_hz;
    const double nearest = std::ceil(place - 0.5 - kTie);
    if (nearest < 0 || nearest >= fast.count) continue;
    const int j = static_cast<int>(nearest);
    PicturePair pair{color_is_slower ? i : j, color_is_slower ? j : i, 0};
    pair.depth_after_s = pair.depth / depth.rate_hz + depth.delay_s - pair.color / color.rate_hz;
    pairs.push_back(pair);
  }
  return pairs;
}

std::vector<std::string> odd_stamps(const std::vector<StampedFile>& files,
                                    const std::string& name) {
  std::vector<std::string> lines;
  const double step_s = median_step_s(files);
  if (const char* unit = seeming_unit(step_s); unit != nullptr)
    lines.push_back(
        fmt::format("{}: pictures are {:g} s apart: times are seconds (these look like "
                    "{}): convert them",
                    name, step_s, unit));
  const auto back = std::adjacent_find(
      files.begin(), files.end(),
      [](const StampedFile& a, const StampedFile& b) { return b.time_s < a.time_s; });
  if (back != files.end())
    lines.push_back(
        fmt::format("{}: the time of '{}' is before that of '{}': frames stay in the "
                    "order of the list, sort it by time",
                    name, std::next(back)->path, back->path));
  return lines;
}

Error no_pairs(const std::vector<StampedFile>& color, const std::vector<StampedFile>& depth,
               const std::string& name, double most_s) {
  if (color.empty() || depth.empty())
    return {ErrorCode::kFormat, name + ": the list of " + (color.empty() ? "colour" : "depth") +
                                    " has no picture: write lines of a time and a file name"};
  double nearest_s = std::numeric_limits<double>::infinity();
  std::vector<double> times;
  for (const StampedFile& file : depth) times.push_back(file.time_s);
  std::sort(times.begin(), times.end());
  for (const StampedFile& file : color) {
    const auto after = std::lower_bound(times.begin(), times.end(), file.time_s);
    if (after != times.end()) nearest_s = std::min(nearest_s, *after - file.time_s);
    if (after != times.begin()) nearest_s = std::min(nearest_s, file.time_s - *std::prev(after));
  }
  return {ErrorCode::kFormat,
          fmt::format("{}: the nearest depth picture is {:g} s away, more than {:g} s: {}", name,
                      nearest_s, most_s, unit_hint(median_step_s(color)))};
}

Error no_poses(const std::vector<StampedPose>& poses, const std::vector<StampedFile>& color,
               const std::string& name) {
  if (poses.empty()) return {ErrorCode::kFormat, name + ": has no pose: give lines with poses"};
  const auto by_time = [](const auto& a, const auto& b) { return a.time_s < b.time_s; };
  const auto [from, to] = std::minmax_element(poses.begin(), poses.end(), by_time);
  const auto [first, last] = std::minmax_element(color.begin(), color.end(), by_time);
  return {ErrorCode::kFormat,
          fmt::format("{}: no frame has a pose: its times are {:.3f} to {:.3f} s, those of the "
                      "pictures {:.3f} to {:.3f} s: give both on one clock",
                      name, from->time_s, to->time_s, first->time_s, last->time_s)};
}

}  // namespace mixrig::take
