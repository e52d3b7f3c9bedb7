// SPDX-License-Identifier: Apache-2.0
// Which pictures of a take make a frame, with its time and pose.
#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "host/capture/take/growing_table.h"
#include "host/capture/take/take_state.h"
#include "host/capture/take/tell_once.h"
#include "host/capture/take/tum_folder.h"
#include "host/math/config/table.h"

namespace mixrig::take {
namespace fs = std::filesystem;

namespace {

constexpr double kMaxPairDifference_s = 0.02;  // the default of TUM's own tools
constexpr double kMaxPoseGap_s = 0.1;

}  // namespace

Result<std::vector<StampedPose>> TakeReader::State::read_poses() {
  const fs::path path = info().root / manifest.pose_file;
  MIXRIG_ASSIGN(const std::string text, read_rows(path));
  return parse_trajectory(text, path.string());
}

/// Reads a table. Of a take that was cut off a row without an end is left out.
Result<std::string> TakeReader::State::read_rows(const fs::path& path) const {
  MIXRIG_ASSIGN(std::string text, config::read_text(path, kMaxListBytes));
  if (manifest.unfinished) text.resize(whole_rows(text).size());
  return text;
}

/// Frames of a recording by mixrig are those of their numbers, whatever their rates.
std::vector<PicturePair> TakeReader::State::pair(StreamInfo stream, const StreamInfo* amplitudes) {
  std::error_code error;
  const bool recorded = fs::exists(info().root / kTicksTable, error);
  if (amplitudes != nullptr) stream.count = std::min(stream.count, amplitudes->count);
  if (!recorded && rates_differ(info().color, stream))
    tell_once(fmt::format("{}: colour at {} Hz and depth at {} Hz are paired by time",
                          info().path.string(), info().color.rate_hz, stream.rate_hz));
  return pair_numbered(info().color, stream, recorded);
}

Result<void> TakeReader::State::index_numbered() {
  const auto pairs = pair(info().depth, info().amplitude ? &*info().amplitude : nullptr);
  std::map<int, PicturePair> second;  // by colour
  if (info().depth2)
    for (const PicturePair& two :
         pair(info().depth2->depth, amplitude2 ? &*info().depth2->amplitude : nullptr))
      second.emplace(two.color, two);
  std::vector<StampedPose> poses;
  if (!manifest.pose_file.empty()) {
    MIXRIG_ASSIGN(poses, read_poses());
  }
  const double rate_hz = info().color.rate_hz;
  for (const PicturePair& two : pairs) {
    FrameIndex frame;
    frame.color = two.color, frame.depth = two.depth, frame.depth_after_s = two.depth_after_s;
    if (info().depth2) {
      const auto other = second.find(two.color);
      if (other == second.end()) continue;
      frame.depth2 = other->second.depth, frame.depth2_after_s = other->second.depth_after_s;
    }
    frame.time_s = rate_hz > 0 ? two.color / rate_hz : 0.0;
    frame.world_from_target = manifest.fixed_pose.value_or(geometry::Pose{});
    if (!manifest.pose_file.empty()) {
      if (static_cast<std::size_t>(two.color) >= poses.size()) break;
      const StampedPose& pose = poses[static_cast<std::size_t>(two.color)];
      frame.time_s = pose.time_s, frame.world_from_target = pose.world_from_target;
    }
    frames.push_back(frame);
  }
  return {};
}

Result<void> TakeReader::State::index_lists(const TumLists& lists) {
  std::vector<StampedPose> poses;
  if (!manifest.pose_file.empty()) {
    MIXRIG_ASSIGN(poses, read_poses());
    // Not stable_sort: libstdc++'s buffer for it is not aligned as Eigen's types need.
    std::sort(poses.begin(), poses.end(),
              [](const StampedPose& a, const StampedPose& b) { return a.time_s < b.time_s; });
  }
  const std::string name = (info().root / info().color.path).string();
  for (const std::string& line : odd_stamps(lists.color, name)) tell_once(line);
  for (const std::string& line :
       odd_stamps(lists.depth, (info().root / info().depth.path).string()))
    tell_once(line);
  const auto pairs = associate(lists.color, lists.depth, kMaxPairDifference_s);
  if (pairs.empty()) return no_pairs(lists.color, lists.depth, name, kMaxPairDifference_s);
  for (const auto& [c, d] : pairs) {
    const double time_s = lists.color[static_cast<std::size_t>(c)].time_s;
    std::optional<geometry::Pose> pose = manifest.fixed_pose.value_or(geometry::Pose{});
    if (!manifest.pose_file.empty()) pose = pose_at(poses, time_s, kMaxPoseGap_s);
    const double after_s = info().depth.delay_s;
    if (pose) frames.push_back({c, d, 0, time_s, after_s, 0, *pose});
  }
  if (frames.empty())
    return no_poses(poses, lists.color, (info().root / manifest.pose_file).string());
  return {};
}

/// Takes the times of a recording without stamped poses from ticks.csv; a rate would only count
/// frames.
void TakeReader::State::take_times_from_ticks() {
  if (!manifest.pose_file.empty() || is_list(info().color)) return;
  const auto first = ticks.find(1);
  if (first == ticks.end()) return;
  for (const auto& [number, tick] : ticks)
    if (number >= 1 && number <= static_cast<int>(frames.size()))
      frames[static_cast<std::size_t>(number - 1)].time_s =
          seconds(tick.mid_exposure - first->second.mid_exposure);
}

}  // namespace mixrig::take
