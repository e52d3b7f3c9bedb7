// SPDX-License-Identifier: Apache-2.0
// A learned map is laid into a scanned room.
#include <nlohmann/json.hpp>

#include "extras/map/learn/map_track.h"
#include "extras/map/reconstruction/maps/map_file.h"
#include "extras/map/reconstruction/maps/map_in_room.h"
#include "hal/base/angles.h"
#include "host/pose/tracker/rig_camera.h"
#include "host/room/scan/room_file.h"

namespace mixrig::session {
namespace {

Image<Rgb8> grey_rgb(const Image<std::uint8_t>& grey) {
  Image<Rgb8> picture(grey.size());
  for (int y = 0; y < grey.height(); ++y)
    for (int x = 0; x < grey.width(); ++x) {
      const std::uint8_t v = grey.row(y)[x];
      picture.row(y)[x] = {v, v, v};
    }
  return picture;
}

/// Poses of the key pictures that the room explains.
std::vector<reconstruction::KeyInRoom> keys_in_room(const reconstruction::LearnedMap& map,
                                                    tracking::Tracker& tracker) {
  std::vector<reconstruction::KeyInRoom> found;
  for (std::size_t k = 0; k < map.keys.size(); ++k) {
    const auto pose = tracker.track(grey_rgb(map.keys[k].grey).view(), map.keys[k].time_s);
    if (pose.known) found.push_back({k, pose.room_from_camera, pose.covariance});
  }
  return found;
}

nlohmann::json report_of(const reconstruction::MapInRoom& place, std::size_t keys) {
  const geometry::Pose& pose = place.room_from_map.pose;
  const Eigen::Vector3d& t = pose.translation_m;
  const Eigen::Quaterniond& q = pose.rotation;
  constexpr double kPercent = 100, kMm = 1e3;
  return {
      {"keys", keys},
      {"keys_found", place.keys},
      {"keys_agree", place.keys_agree},
      {"points", place.points},
      {"points_agree", place.points_agree},
      {"metres_per_unit", place.room_from_map.scale},
      {"scale_sigma_pct", kPercent * place.scale_sigma()},
      {"sigma_mm", kMm * place.sigma_m()},
      {"sigma_deg", place.sigma_rad() / kDeg},
      {"room_from_map",
       {{"translation", {t.x(), t.y(), t.z()}}, {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}}}};
}

}  // namespace

Result<nlohmann::json> place_map(const MapRoomOptions& options) {
  MIXRIG_ASSIGN(const reconstruction::LearnedMap map, reconstruction::load_map(options.map));
  MIXRIG_ASSIGN(const auto rooms, model::load_rooms(options.room));
  const model::RoomFile& room = rooms.front().room;  // of joined rooms the first
  MIXRIG_ASSIGN(const RigCamera camera, rig_camera(options.calibration, map.camera));
  if (map.keys.front().grey.size() != geometry::size_px(camera.model))
    return Error{ErrorCode::kData, options.map.string() +
                                       ": was learned from pictures of another size than the "
                                       "calibration: calibrate at that size, or learn the map "
                                       "again"};
  Crew crew(options.threads);
  tracking::TrackerOptions tracking = options.tracker;
  tracking.distance_sigma = room.manifest.distance_sigma;
  tracking::Tracker tracker(room.panorama, camera.model, tracking, crew);
  const auto found = keys_in_room(map, tracker);
  const auto place = reconstruction::place_in_room(map, room.panorama, found);
  if (!place)
    return Error{place.error().code, options.map.string() + ", " + options.room.string() + ": " +
                                         place.error().context};
  reconstruction::LearnedMap placed = reconstruction::in_room(map, *place);
  placed.room->world_from_room = room.manifest.world_from_base;
  MIXRIG_TRY(reconstruction::write_map(placed, options.out));
  return report_of(*place, map.keys.size());
}

}  // namespace mixrig::session
