// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/mocap_track.h"

#include <string>

#include "hal/base/log.h"
#include "host/math/estimation/markers/constellation.h"

namespace mixrig::pose {
namespace {

using capture::PoseCovariance;
using geometry::Pose;

/// A body's pose in the stream's world.
struct BodySeen {
  Pose world_from_body;
  std::optional<PoseCovariance> covariance;
};

std::optional<BodySeen> by_markers(const stream::NatNetFrame& frame,
                                   const mocap::Constellation& constellation) {
  std::vector<Eigen::Vector3d> seen;
  for (const stream::NatNetMarker& marker : frame.markers)
    if (!marker.occluded) seen.push_back(marker.position_m);
  const auto match =
      estimation::match_constellation(constellation.markers_m, seen, {constellation.sigma_m, 0});
  if (!match.usable()) return std::nullopt;
  return BodySeen{match.value.world_from_body, PoseCovariance(match.covariance)};
}

std::optional<BodySeen> by_number(const stream::NatNetFrame& frame, int id) {
  if (id == 0 && frame.bodies.size() != 1) return std::nullopt;
  for (const stream::NatNetBody& body : frame.bodies)
    if ((id == 0 || body.id == id) && body.tracked) return BodySeen{body.world_from_body, {}};
  return std::nullopt;
}

/// "3, 7".
std::string ids_of(const stream::NatNetFrame& frame) {
  std::string ids;
  for (const stream::NatNetBody& body : frame.bodies)
    ids += (ids.empty() ? "" : ", ") + std::to_string(body.id);
  return ids;
}

std::string what_to_do(BodyTrouble trouble, const stream::NatNetFrame& frame, int wanted) {
  switch (trouble) {
    case BodyTrouble::kNoBody:
      return "no body is streamed: let the server stream rigid bodies, or name the camera's "
             "markers "
             "by camera.constellation";
    case BodyTrouble::kSeveral:
      return "several bodies are streamed (" + ids_of(frame) +
             "): name the camera's by camera.body";
    case BodyTrouble::kAnother:
      return "camera.body is " + std::to_string(wanted) + ", but only others are streamed (" +
             ids_of(frame) + ")";
    case BodyTrouble::kNone:
      break;
  }
  return {};
}

}  // namespace

BodyTrouble body_trouble(const stream::NatNetFrame& frame, const MocapOptions& options) {
  if (options.constellation) return BodyTrouble::kNone;
  if (frame.bodies.empty()) return BodyTrouble::kNoBody;
  if (options.body_id == 0)
    return frame.bodies.size() > 1 ? BodyTrouble::kSeveral : BodyTrouble::kNone;
  for (const stream::NatNetBody& body : frame.bodies)
    if (body.id == options.body_id) return BodyTrouble::kNone;
  return BodyTrouble::kAnother;
}

std::optional<TargetSeen> target_seen(const stream::NatNetFrame& frame,
                                      const MocapOptions& options) {
  const auto body = options.constellation ? by_markers(frame, *options.constellation)
                                          : by_number(frame, options.body_id);
  if (!body) return std::nullopt;
  const Pose z_up = mocap::z_up_from(options.up);
  PoseCovariance turn = PoseCovariance::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = z_up.rotation.toRotationMatrix();
  TargetSeen seen = on_body(body->world_from_body, body->covariance, options.mount);
  seen.world_from_target = z_up * seen.world_from_target;
  if (seen.covariance) seen.covariance = turn * *seen.covariance * turn.transpose();
  return seen;
}

void MocapTrack::add(const stream::NatNetFrame& frame, HostTime received) {
  track_.add(frame.time_s, target_seen(frame, options_), received);
  const BodyTrouble trouble = body_trouble(frame, options_);
  const std::lock_guard lock(mutex_);
  bool& warned = warned_[static_cast<std::size_t>(trouble)];
  if (trouble == BodyTrouble::kNone || warned) return;
  warned = true;
  log_warning("pose", "motion capture: " + what_to_do(trouble, frame, options_.body_id));
}

void MocapTrack::set_packets(const stream::NatNetCounts& counts) {
  const std::lock_guard lock(mutex_);
  counts_ = counts;
}

capture::PoseFaults MocapTrack::faults() const {
  capture::PoseFaults all = track_.faults();
  const std::lock_guard lock(mutex_);
  all.packets_lost = static_cast<std::uint64_t>(counts_.lost);
  all.packets_late = static_cast<std::uint64_t>(counts_.late);
  all.packets_bad = static_cast<std::uint64_t>(counts_.malformed);
  all.packets_foreign = static_cast<std::uint64_t>(counts_.foreign);
  return all;
}

capture::PoseStream MocapTrack::stream() const {
  capture::PoseStream stream = track_.stream();
  const std::lock_guard lock(mutex_);
  stream.packets = static_cast<std::uint64_t>(counts_.frames);
  return stream;
}

}  // namespace mixrig::pose
