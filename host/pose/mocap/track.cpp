// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/track.h"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "host/math/estimation/markers/constellation.h"

namespace mixrig::mocap {

using geometry::Pose;

Pose z_up_from(Up up) {
  if (up == Up::kZ) return {};
  return {Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX())), {0, 0, 0}};
}

MocapTrack track_markers(const std::vector<stream::NatNetFrame>& frames,
                         const Constellation& constellation, const TrackOptions& options) {
  MocapTrack track;
  const Pose z_up = z_up_from(options.up);
  double squared = 0;
  int count = 0;
  for (const stream::NatNetFrame& frame : frames) {
    ++track.frames;
    std::vector<Eigen::Vector3d> seen;
    for (const stream::NatNetMarker& marker : frame.markers)
      if (!marker.occluded) seen.push_back(marker.position_m);
    const auto match =
        estimation::match_constellation(constellation.markers_m, seen, {constellation.sigma_m, 0});
    if (!match.usable()) {
      ++track.refused[match.verdict.reason];
      continue;
    }
    for (int i : match.inliers) squared += match.residuals[i] * match.residuals[i], ++count;
    track.poses.push_back(
        {frame.time_s, z_up * match.value.world_from_body * options.body_from_camera});
  }
  if (count > 0) track.residual_rms_m = std::sqrt(squared / count);
  return track;
}

Result<MocapTrack> track_bodies(const std::vector<stream::NatNetFrame>& frames,
                                const TrackOptions& options) {
  std::set<int> ids;
  for (const stream::NatNetFrame& frame : frames)
    for (const stream::NatNetBody& body : frame.bodies) ids.insert(body.id);
  std::string known;
  for (int id : ids) known += " " + std::to_string(id);
  if (ids.empty())
    return Error{ErrorCode::kData,
                 "the recording holds no rigid body: name its markers by --constellation"};
  if (options.body_id == 0 && ids.size() > 1)
    return Error{ErrorCode::kData,
                 "the recording holds several bodies: choose one by --body:" + known};
  if (options.body_id != 0 && !ids.contains(options.body_id))
    return Error{ErrorCode::kData, "the recording holds no body " +
                                       std::to_string(options.body_id) + ": it holds" + known};
  const int wanted = options.body_id != 0 ? options.body_id : *ids.begin();
  MocapTrack track;
  const Pose z_up = z_up_from(options.up);
  for (const stream::NatNetFrame& frame : frames) {
    ++track.frames;
    const stream::NatNetBody* found = nullptr;
    for (const stream::NatNetBody& body : frame.bodies)
      if (body.id == wanted) found = &body;
    if (found == nullptr || !found->tracked) {
      ++track
            .refused[found == nullptr ? "the body is not in the frame" : "the body is not tracked"];
      continue;
    }
    track.poses.push_back({frame.time_s, z_up * found->world_from_body * options.body_from_camera});
  }
  return track;
}

std::string to_tum(const MocapTrack& track) {
  std::string text = "# t x y z qx qy qz qw, z up, seconds and metres\n";
  for (const TrackedPose& p : track.poses) {
    const auto& t = p.world_from_camera.translation_m;
    const auto& q = p.world_from_camera.rotation;
    text += fmt::format("{:.6f} {:.7f} {:.7f} {:.7f} {:.9f} {:.9f} {:.9f} {:.9f}\n", p.time_s,
                        t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

}  // namespace mixrig::mocap
