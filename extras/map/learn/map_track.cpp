// SPDX-License-Identifier: Apache-2.0
#include "extras/map/learn/map_track.h"

#include <chrono>
#include <cmath>

#include "extras/map/learn/path_errors.h"
#include "extras/map/reconstruction/maps/map_file.h"
#include "extras/map/reconstruction/maps/map_finder.h"
#include "extras/map/reconstruction/maps/map_join.h"
#include "extras/map/reconstruction/maps/map_patches.h"
#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"
#include "host/capture/take/take_source.h"
#include "host/pose/tracker/room_track.h"

namespace mixrig::session {
namespace {

/// The tracker is made for rooms in metres: a map without scale is tracked as if half of its points
/// were nearer than 3 m to its origin. Tracker's units per unit of the map.
double room_size(const reconstruction::LearnedMap& map) {
  if (map.scale) return 1;
  constexpr double kUsual_m = 3;
  std::vector<double> ranges;
  for (const auto& p : map.points) ranges.push_back(p.place.norm());
  const double middle = median_in_place(std::span<double>(ranges));
  return middle > 0 ? kUsual_m / middle : 1;
}

/// Results of tracking all pictures.
struct Followed {
  RoomTrack track;
  std::vector<trajectory::TimedPose> path;  ///< in units of the map
  std::vector<PosePair> pairs;
};

/// `place`: of the room in the world, where the map has its axes and that is known.
Result<Followed> follow_take(const MapTrackOptions& options, TrackedCamera by,
                             capture::CaptureSource& source, const RigCamera& camera,
                             tracking::Tracker& tracker, double size,
                             const std::optional<geometry::Pose>& place) {
  const TruePath truth(by, options.take, source.info(), camera);
  Followed followed;
  capture::Capture capture;
  for (int number = 1; number <= source.info().frames; ++number) {
    MIXRIG_ASSIGN(const bool there, source.read(number, capture));
    if (!there) break;
    const TakePicture picture = picture_of(capture, by);
    if (picture.image == nullptr) continue;
    MIXRIG_TRY(check_size(picture, camera.model, options.take));
    const auto start = std::chrono::steady_clock::now();
    TrackedPicture tracked;
    tracked.time_s = picture.time_s;
    tracked.pose = tracker.track(*picture.image, picture.time_s);
    tracked.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    followed.track.seconds += tracked.seconds;
    const auto world_from_target = truth.at(picture.time_s, capture);
    tracked.world_from_target = place.value_or(geometry::Pose{}) * tracked.pose.room_from_camera *
                                camera.camera_from_target;
    if (place) tracked.truth = world_from_target;
    followed.track.pictures.push_back(tracked);
    if (!tracked.pose.known) continue;
    geometry::Pose pose = tracked.pose.room_from_camera;
    pose.translation_m /= size;
    followed.path.push_back({picture.time_s, pose});
    if (world_from_target)
      followed.pairs.push_back(
          {pose, *world_from_target * geometry::inverse(camera.camera_from_target)});
  }
  if (followed.track.pictures.empty())
    return Error{ErrorCode::kData,
                 options.take.string() +
                     ": has no pictures of the camera that learned the map: record it "
                     "with that camera in rig.toml"};
  followed.track.counts = tracker.counts();
  return followed;
}

std::optional<geometry::Pose> place_of(const reconstruction::LearnedMap& map,
                                       const MapTrackOptions& options) {
  if (!map.room) return std::nullopt;
  return options.world_from_room ? options.world_from_room : map.room->world_from_room;
}

}  // namespace

Result<MapTrack> track_map(const MapTrackOptions& options) {
  MIXRIG_ASSIGN(reconstruction::LearnedMap map, reconstruction::load_map(options.map));
  const TrackedCamera by =
      map.camera == "target" ? TrackedCamera::kTarget : TrackedCamera::kFisheye;
  MIXRIG_ASSIGN(const auto source, take::open_take_source(options.take));
  MIXRIG_ASSIGN(const RigCamera camera, tracked_camera(by, options.calibration, source->info()));
  if (map.keys.front().grey.size() != geometry::size_px(camera.model))
    return Error{ErrorCode::kData, options.map.string() +
                                       ": was learned from pictures of another size: calibrate the "
                                       "camera at that size, or learn the map again"};
  const double size = room_size(map);
  reconstruction::rescale(map, size);
  Crew crew(options.threads);
  tracking::Tracker tracker(
      reconstruction::patches_of(map, camera.model), camera.model, options.tracker,
      [&](const tracking::PatchMap& patches, const geometry::AnyCamera& own) {
        return std::make_unique<reconstruction::MapFinder>(map, patches, own,
                                                           options.tracker.align);
      },
      crew);
  const auto place = place_of(map, options);
  MIXRIG_ASSIGN(const Followed followed,
                follow_take(options, by, *source, camera, tracker, size, place));
  MapTrack result;
  result.report = to_json(followed.track);
  result.report.erase("nees");  // the covariance of a map is not known
  result.report["scale_of_map"] = map.scale ? "metric" : "unknown";
  result.report["axes"] = map.room ? "room" : "map";
  if (!map.scale) result.report.erase("sigma_mm");
  const nlohmann::json errors = errors_of_path(followed.pairs, !map.scale);
  if (!place && errors.is_object()) result.report.update(errors);
  result.tum = map.room ? to_tum(followed.track) : reconstruction::tum_text(followed.path);
  result.lost = followed.path.empty();
  return result;
}

Result<nlohmann::json> join_maps(const std::filesystem::path& first,
                                 const std::filesystem::path& second,
                                 const std::filesystem::path& out) {
  MIXRIG_ASSIGN(const reconstruction::LearnedMap a, reconstruction::load_map(first));
  MIXRIG_ASSIGN(const reconstruction::LearnedMap b, reconstruction::load_map(second));
  const auto joined = reconstruction::join(a, b);
  if (!joined)
    return Error{joined.error().code,
                 first.string() + ", " + second.string() + ": " + joined.error().context};
  MIXRIG_TRY(reconstruction::write_map(reconstruction::in_first(b, a, *joined), out));
  const estimation::Similarity& map = joined->first_from_second;
  const Eigen::Vector3d& t = map.pose.translation_m;
  const Eigen::Quaterniond &q = map.pose.rotation, &rig = joined->alignment.a_from_b;
  return nlohmann::json{
      {"time_offset_s", joined->alignment.time_offset_s},
      {"time_offset_sigma_s", joined->alignment.time_offset_sigma_s},
      {"rotation_xyzw", {rig.x(), rig.y(), rig.z(), rig.w()}},
      {"rotation_sigma_deg", joined->alignment.rotation_sigma_rad / kDeg},
      {"scale", map.scale},
      {"scale_sigma_pct", 100 * joined->scale_sigma},
      {"spread", joined->spread},
      {"first_from_second",
       {{"translation", {t.x(), t.y(), t.z()}}, {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}}}};
}

}  // namespace mixrig::session
