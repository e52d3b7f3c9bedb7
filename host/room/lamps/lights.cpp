// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/lights.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "hal/base/angles.h"
#include "host/capture/take/take_source.h"
#include "host/math/image_io/image_io.h"
#include "host/pose/tracker/room_track.h"
#include "host/room/lamps/bright_regions.h"
#include "host/room/lamps/lamp_intensity.h"
#include "host/room/lamps/room_lamps.h"
#include "host/room/scan/room_file.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// Pose of the target camera at a picture's time.
class PathOfTake {
 public:
  PathOfTake(std::vector<trajectory::TimedPose> samples, const geometry::Pose& body_from_target)
      : path_(std::move(samples)), body_from_target_(body_from_target) {}
  explicit PathOfTake(TruePath truth) : truth_(std::move(truth)) {}

  std::optional<geometry::Pose> at(double time_s, const capture::Capture& capture) const {
    if (truth_) return truth_->at(time_s, capture);
    const auto pose = path_->at(time_s);
    return pose ? std::optional(*pose * body_from_target_) : std::nullopt;
  }

 private:
  std::optional<trajectory::Trajectory> path_;
  std::optional<TruePath> truth_;
  geometry::Pose body_from_target_;
};

Result<PathOfTake> path_of(const LightsOptions& options, const capture::SourceInfo& info,
                           const RigCamera& camera) {
  if (!options.poses.empty()) {
    MIXRIG_ASSIGN(auto samples, trajectory::read_samples(options.poses));
    return PathOfTake(std::move(samples),
                      options.poses_of_fisheye ? camera.camera_from_target : geometry::Pose{});
  }
  if (options.room.empty())
    return PathOfTake(TruePath(TrackedCamera::kFisheye, options.take, info, camera));
  RoomTrackOptions tracking;
  tracking.room = options.room, tracking.take = options.take;
  tracking.calibration = options.calibration, tracking.world_from_base = options.world_from_base;
  tracking.threads = options.threads, tracking.progress = options.progress;
  MIXRIG_ASSIGN(const RoomTrack track, track_room(tracking));
  std::vector<trajectory::TimedPose> samples;
  for (const TrackedPicture& p : track.pictures)
    if (p.pose.known) samples.push_back({p.time_s, p.world_from_target});
  return PathOfTake(std::move(samples), {});
}

struct TakeViews {
  std::vector<lights::LampView> views;
  std::vector<int> frames;  ///< of each view
  int without_pose = 0;
};

Result<TakeViews> views_of(const LightsOptions& options, capture::CaptureSource& source,
                           const RigCamera& camera, const PathOfTake& path) {
  TakeViews all;
  capture::Capture capture;
  const auto ray = [&](const Eigen::Vector2d& px) { return unproject(camera.model, px); };
  for (int frame = 1; frame <= source.info().frames; ++frame) {
    MIXRIG_ASSIGN(const bool there, source.read(frame, capture));
    if (!there) break;
    if (options.progress) options.progress(frame, source.info().frames);
    const TakePicture picture = picture_of(capture, TrackedCamera::kFisheye);
    if (picture.image == nullptr) continue;
    MIXRIG_TRY(check_size(picture, camera.model, options.take));
    const auto world_from_target = path.at(picture.time_s, capture);
    if (!world_from_target) {
      ++all.without_pose;
      continue;
    }
    all.views.push_back({*world_from_target * geometry::inverse(camera.camera_from_target),
                         lights::find_bright_regions(*picture.image, ray)});
    all.frames.push_back(frame);
  }
  if (all.views.empty())
    return Error{ErrorCode::kData,
                 options.take.string() + (all.without_pose == 0
                                              ? ": has no pictures of a fisheye: record it with "
                                                "the fisheye in rig.toml"
                                              : ": no picture of its fisheye has a pose: give "
                                                "--poses, or the scanned room by --model")};
  return all;
}

Result<int> view_of_frame(const TakeViews& all, int frame) {
  const auto off = [&](int a) { return std::abs(a - frame); };
  const auto nearest = std::min_element(all.frames.begin(), all.frames.end(),
                                        [&](int a, int b) { return off(a) < off(b); });
  if (*nearest == frame) return static_cast<int>(nearest - all.frames.begin());
  return Error{
      ErrorCode::kUsage,
      fmt::format("lights: --bracket-frame {}: the take has no picture of the fisheye with "
                  "a pose there: the nearest is of frame {}",
                  frame, *nearest)};
}

void draw_ring(const Eigen::Vector2d& centre, double radius_px, Rgb8 color, Image<Rgb8>& picture) {
  const int steps = static_cast<int>(16 * radius_px) + 32;
  for (int k = 0; k < steps; ++k)
    for (const double r : {radius_px, radius_px + 1}) {
      const double turn = 2 * kPi * k / steps;
      const int x = static_cast<int>(std::lround(centre.x() + r * std::cos(turn)));
      const int y = static_cast<int>(std::lround(centre.y() + r * std::sin(turn)));
      if (x >= 0 && y >= 0 && x < picture.width() && y < picture.height()) picture.at(x, y) = color;
    }
}

/// Green rings around lamps, red ones around what is none.
void draw_candidates(const lights::LampSearch& search, const std::vector<lights::LampView>& views,
                     int view, Image<Rgb8>& picture) {
  const auto draw = [&](const std::vector<lights::Sighting>& seen, Rgb8 color) {
    for (const lights::Sighting& s : seen) {
      if (s.view != view) continue;
      const auto& region =
          views[static_cast<std::size_t>(view)].regions[static_cast<std::size_t>(s.region)];
      draw_ring(region.centre_px, 4 + std::sqrt(region.pixels / 2.0), color, picture);
    }
  };
  for (const auto& rejected : search.rejected) draw(rejected.seen, {255, 60, 50});
  for (const auto& lamp : search.lamps) draw(lamp.seen, {60, 255, 60});
}

std::vector<geometry::Lamp> scene_lamps(const RoomLights& found) {
  const auto intensities =
      lights::lamp_intensities(found.search.lamps, found.light, found.radiance);
  std::vector<geometry::Lamp> lamps;
  for (const lights::FoundLamp& of_search : found.search.lamps) {
    geometry::Lamp lamp = of_search;
    lamp.name = fmt::format("found {}", lamps.size() + 1);
    lamp.intensity = intensities[lamps.size()];
    lamps.push_back(std::move(lamp));
  }
  return lamps;
}

Result<std::optional<lights::RoomSurfaces>> room_of(const LightsOptions& options) {
  std::optional<lights::RoomSurfaces> surfaces;
  if (options.room.empty()) return surfaces;
  MIXRIG_ASSIGN(auto rooms, model::load_rooms(options.room));
  model::RoomFile& room = rooms.front().room;  // of joined rooms the first
  if (rooms.size() == 1) MIXRIG_TRY(model::load_light(options.room, room.panorama));
  const auto place =
      options.world_from_base ? options.world_from_base : room.manifest.world_from_base;
  surfaces.emplace(std::move(room.panorama), place.value_or(options.otherwise_from_base));
  return surfaces;
}

Result<RoomLights> lights_of_take(const LightsOptions& options, const lights::RoomSurfaces* room) {
  MIXRIG_ASSIGN(const auto source, take::open_take_source(options.take));
  MIXRIG_ASSIGN(const RigCamera camera,
                tracked_camera(TrackedCamera::kFisheye, options.calibration, source->info()));
  MIXRIG_ASSIGN(const PathOfTake path, path_of(options, source->info(), camera));
  MIXRIG_ASSIGN(const TakeViews all, views_of(options, *source, camera, path));
  RoomLights found;
  found.pictures = static_cast<int>(all.views.size()), found.without_pose = all.without_pose;
  found.search = lights::find_lamps(all.views, room, options.lamps);
  if (!options.bracket.empty()) {
    MIXRIG_ASSIGN(const int view, view_of_frame(all, options.bracket_frame));
    MIXRIG_ASSIGN(found.radiance, radiance_by_bracket(options.bracket, camera.model, all.views,
                                                      view, found.search.lamps));
  }
  if (options.drawing.empty()) return found;
  // Takes a view in the middle of those used.
  int view = 0;
  for (const auto& lamp : found.search.lamps) view = lamp.seen[lamp.seen.size() / 2].view;
  for (const auto& rejected : found.search.rejected)
    if (found.search.lamps.empty()) view = rejected.seen.front().view;
  capture::Capture capture;
  MIXRIG_ASSIGN(const bool there,
                source->read(all.frames[static_cast<std::size_t>(view)], capture));
  if (!there) return found;
  draw_candidates(found.search, all.views, view, capture.fisheye);
  MIXRIG_TRY(image_io::write_png(options.drawing, capture.fisheye));
  return found;
}

Result<void> add_lights_of_room(const LightsOptions& options, const lights::RoomSurfaces& room,
                                RoomLights& found) {
  const std::vector<lights::LampView> views{lights::view_of_room(room)};
  found.pictures = 1;
  found.search = lights::find_lamps(views, &room, options.lamps);
  if (options.drawing.empty()) return {};
  Image<Rgb8> picture = room.panorama().color;
  draw_candidates(found.search, views, 0, picture);
  return image_io::write_png(options.drawing, picture);
}

/// Measures the light, and takes out lamps that no place owes 1 % of its light to.
void measure(const lights::RoomSurfaces& room, double exposure, RoomLights& found) {
  constexpr double kLeastShare = 0.01;
  lights::ShadingOptions options;
  options.exposure = exposure;
  auto& lamps = found.search.lamps;
  while (!lamps.empty()) {
    found.light = lights::measure_light(room, lamps, options);
    if (!found.light.usable()) return;
    const auto& share = found.light.value.largest_share;
    const auto least = std::min_element(share.begin(), share.end());
    if (*least >= kLeastShare) return;
    const auto at = lamps.begin() + (least - share.begin());
    const Vector3d eye = room.world_from_base().translation_m;
    found.search.rejected.push_back({lights::Refusal::kDark, at->position_m, eye,
                                     (at->position_m - eye).normalized(), at->surround, at->seen});
    if (!found.radiance.empty())
      found.radiance.erase(found.radiance.begin() + (at - lamps.begin()));
    lamps.erase(at);
  }
  found.light = {};
}

}  // namespace

Result<RoomLights> find_lights(const LightsOptions& options) {
  if (options.take.empty() && options.room.empty())
    return Error{ErrorCode::kUsage, "lights: neither --take nor --model: give one, or both"};
  if (options.take.empty() && !options.bracket.empty())
    return Error{ErrorCode::kUsage,
                 "lights: --bracket needs --take: give the take of the same fisheye"};
  MIXRIG_ASSIGN(const auto room, room_of(options));
  RoomLights found;
  if (options.take.empty()) {
    MIXRIG_TRY(add_lights_of_room(options, *room, found));
  } else {
    MIXRIG_ASSIGN(found, lights_of_take(options, room ? &*room : nullptr));
  }
  if (room) measure(*room, options.exposure, found);
  found.lamps = scene_lamps(found);
  return found;
}

}  // namespace mixrig::session
