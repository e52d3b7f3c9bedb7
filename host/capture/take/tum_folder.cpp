// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D folders.
#include "host/capture/take/tum_folder.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace mixrig::take {
namespace fs = std::filesystem;

bool is_tum_folder(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "rgb.txt", error) &&
         fs::is_regular_file(folder / "depth.txt", error);
}

Manifest tum_manifest(const fs::path& folder) {
  Manifest manifest;
  TakeInfo& info = manifest.info;
  info.path = info.root = folder;
  info.name = folder.filename().string();
  info.color.path = "rgb.txt";
  info.depth.path = "depth.txt";
  info.depth_unit_m = 1.0 / 5000.0;
  info.target.pinhole = {{640, 480}, 525.0, 525.0, 319.5, 239.5};
  info.tof = info.target;
  std::error_code error;
  info.has_poses = fs::is_regular_file(folder / "groundtruth.txt", error);
  if (info.has_poses) manifest.pose_file = "groundtruth.txt";
  return manifest;
}

std::vector<std::pair<int, int>> associate(const std::vector<StampedFile>& color,
                                           const std::vector<StampedFile>& depth,
                                           double max_difference_s) {
  std::vector<std::pair<double, int>> depth_times;
  for (std::size_t d = 0; d < depth.size(); ++d)
    depth_times.emplace_back(depth[d].time_s, static_cast<int>(d));
  std::sort(depth_times.begin(), depth_times.end());

  std::vector<std::tuple<double, int, int>> candidates;
  for (std::size_t c = 0; c < color.size(); ++c) {
    const double t = color[c].time_s;
    // A few neighbours in time are enough, and bound the cost for lists of equal stamps.
    constexpr std::ptrdiff_t kNeighbours = 4;
    const auto here = std::lower_bound(depth_times.begin(), depth_times.end(), std::pair(t, 0));
    auto at = here - std::min(kNeighbours, here - depth_times.begin());
    const auto end = here + std::min(kNeighbours, depth_times.end() - here);
    for (; at != end; ++at)
      if (const double difference = std::abs(at->first - t); difference <= max_difference_s)
        candidates.emplace_back(difference, static_cast<int>(c), at->second);
  }
  std::sort(candidates.begin(), candidates.end());

  std::vector<bool> color_taken(color.size()), depth_taken(depth.size());
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [difference, c, d] : candidates) {
    if (color_taken[static_cast<std::size_t>(c)] || depth_taken[static_cast<std::size_t>(d)])
      continue;
    color_taken[static_cast<std::size_t>(c)] = depth_taken[static_cast<std::size_t>(d)] = true;
    pairs.emplace_back(c, d);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace mixrig::take
