// SPDX-License-Identifier: Apache-2.0
#include "host/tools/room/scan_merge.h"

#include <cmath>
#include <cstdio>
#include <sstream>

#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "host/room/registration/room_merge.h"
#include "host/run/report/run_report.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

Result<geometry::Pose> near_pose(const std::string& text) {
  std::istringstream in(text);
  double x = 0, y = 0, z = 0, yaw_deg = 0;
  std::string rest;
  const bool read = static_cast<bool>(in >> x >> y >> z >> yaw_deg);
  if (!read || in >> rest || !std::isfinite(x + y + z + yaw_deg))
    return Error{ErrorCode::kUsage,
                 "--near \"" + text + "\" is not \"x y z yaw\", in metres and degrees"};
  return geometry::Pose{
      Eigen::Quaterniond(Eigen::AngleAxisd(yaw_deg * kDeg, Eigen::Vector3d::UnitZ())), {x, y, z}};
}

nlohmann::json registration_json(const model::Registration& r, std::size_t number) {
  const Eigen::Vector3d& t = r.a_from_b.translation_m;
  const Eigen::Vector3d ahead = r.a_from_b.rotation * Eigen::Vector3d::UnitY();
  const double yaw_deg = std::atan2(-ahead.x(), ahead.y()) / kDeg;
  std::printf(
      "room %zu stood at (%.3f, %.3f, %.3f) m, yaw %.2f deg, in the axes of room 1: to %.1f mm "
      "and %.3f deg\n  %.0f %% of the surfaces are seen from both, %.1f %% of them agree, held "
      "out %.1f mm, next answer %.0f %%\n",
      number, t.x(), t.y(), t.z(), yaw_deg, 1e3 * r.sigma_m, r.sigma_rad / kDeg,
      100 * r.overlap_share, 100 * r.agreeing_share, 1e3 * r.held_out_m, 100 * r.runner_up);
  nlohmann::json moved = nlohmann::json::array();
  for (const model::MovedArea& area : r.moved) {
    std::printf(
        "  room %zu at azimuth %.0f, elevation %.0f deg: %.0f square degrees stand where "
        "the other sees through: moved\n",
        area.in_b ? number : std::size_t{1}, area.azimuth_deg, area.elevation_deg, area.square_deg);
    moved.push_back({{"room", area.in_b ? number : std::size_t{1}},
                     {"azimuth_deg", area.azimuth_deg},
                     {"elevation_deg", area.elevation_deg},
                     {"square_deg", area.square_deg}});
  }
  const Eigen::Quaterniond& q = r.a_from_b.rotation;
  return {{"translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"yaw_deg", yaw_deg},
          {"sigma_mm", 1e3 * r.sigma_m},
          {"sigma_deg", r.sigma_rad / kDeg},
          {"overlap_pct", 100 * r.overlap_share},
          {"agreeing_pct", 100 * r.agreeing_share},
          {"held_out_mm", 1e3 * r.held_out_m},
          {"color_agreement", r.color_agreement},
          {"runner_up_pct", 100 * r.runner_up},
          {"places", r.places},
          {"moved", moved}};
}

}  // namespace

Result<nlohmann::json> scan_merge(const ScanMergeOptions& options, const std::string& out,
                                  int threads) {
  session::RoomMergeOptions merge;
  merge.rooms.assign(options.rooms.begin(), options.rooms.end());
  merge.out = out, merge.threads = threads;
  // "--merge A B OUT" takes all three words.
  if (out.empty()) merge.out = merge.rooms.back(), merge.rooms.pop_back();
  if (!options.near.empty()) {
    if (merge.rooms.size() != 2)
      return Error{ErrorCode::kUsage, "--near is for two rooms: give --merge A B OUT"};
    MIXRIG_ASSIGN(merge.near_first_from_base, near_pose(options.near));
  }
  MIXRIG_ASSIGN(const session::RoomMerge joined, session::merge_rooms(merge));
  nlohmann::json registrations = nlohmann::json::array();
  for (std::size_t i = 0; i < joined.registrations.size(); ++i)
    registrations.push_back(registration_json(joined.registrations[i], i + 2));
  std::printf("%zu triangles, %zu in the rooms alone; %.2f s, %.2f of it to register\n",
              joined.triangles, joined.triangles_alone, joined.seconds, joined.register_seconds);
  return with_end(nlohmann::json{{"rooms", merge.rooms.size()},
                                 {"registrations", registrations},
                                 {"triangles", joined.triangles},
                                 {"triangles_alone", joined.triangles_alone},
                                 {"seconds", joined.seconds},
                                 {"register_seconds", joined.register_seconds},
                                 {"mesh_seconds", joined.mesh_seconds},
                                 {"rss_mb", session::peak_rss_mb()}},
                  merge.out.string(), "mixrig info " + merge.out.string());
}

}  // namespace mixrig::tools
