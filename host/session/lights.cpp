// SPDX-License-Identifier: Apache-2.0
#include "host/session/lights.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/partial_path.h"
#include "hal/base/srgb.h"
#include "host/config/table.h"
#include "host/image_io/image_io.h"
#include "host/lights/bright_regions.h"
#include "host/lights/room_lamps.h"
#include "host/model/room_file.h"
#include "host/scene/scene_edit.h"
#include "host/session/room_track.h"
#include "host/take/take_source.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// Where the target camera was at a picture's time.
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

/// Each lamp's part of the light of all, by its area and its radiance; without a bracket lamps have
/// the same radiance.
std::vector<float> parts_of_light(const RoomLights& found) {
  std::vector<double> light;
  double all = 0;
  for (std::size_t i = 0; i < found.search.lamps.size(); ++i) {
    const double radiance = found.radiance.empty() ? 1 : found.radiance[i];
    light.push_back(radiance * found.search.lamps[i].size_m.prod());
    all += light.back();
  }
  std::vector<float> parts;
  for (const double part : light)
    parts.push_back(all > 0 ? static_cast<float>(part / all)
                            : 1 / static_cast<float>(light.size()));
  return parts;
}

/// Without a measure lamps are together as bright as a common room's.
void assume_intensity(const RoomLights& found, std::vector<scene::Lamp>& lamps) {
  constexpr float kTogether = 8;
  const std::vector<float> parts = parts_of_light(found);
  for (std::size_t i = 0; i < lamps.size(); ++i)
    lamps[i].intensity.setConstant(kTogether * parts[i]);
}

/// By the room's shading; where there is a bracket, that says how the sum is shared out.
void take_intensity(const RoomLights& found, std::vector<scene::Lamp>& lamps) {
  const Eigen::Vector3f luminance(kRec709Red, kRec709Green, kRec709Blue);
  float all = 0;
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    lamps[i].intensity = found.light.value.intensity[i];
    all += luminance.dot(lamps[i].intensity);
  }
  if (found.radiance.empty()) return;
  const std::vector<float> parts = parts_of_light(found);
  for (std::size_t i = 0; i < lamps.size(); ++i) {
    const float own = luminance.dot(lamps[i].intensity);
    if (own > 0)
      lamps[i].intensity *= parts[i] * all / own;
    else
      lamps[i].intensity.setConstant(parts[i] * all);
  }
}

std::vector<scene::Lamp> scene_lamps(const lights::LampSearch& search) {
  std::vector<scene::Lamp> lamps;
  for (const lights::FoundLamp& found : search.lamps) {
    scene::Lamp lamp;
    lamp.name = fmt::format("found {}", lamps.size() + 1);
    lamp.position_m = found.position_m, lamp.direction = found.direction;
    lamp.size_m = found.size_m;
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
  // Of a view that was used, in the middle.
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

template <typename Vector>
nlohmann::json numbers(const Vector& v) {
  nlohmann::json list = nlohmann::json::array();
  for (int i = 0; i < v.size(); ++i) list.push_back(v[i]);
  return list;
}

nlohmann::json lamp_json(const lights::FoundLamp& found, const scene::Lamp& lamp) {
  nlohmann::json json = {{"name", lamp.name},
                         {"position_m", numbers(found.position_m)},
                         {"direction", nullptr},
                         {"size_m", numbers(found.size_m)},
                         {"intensity", numbers(lamp.intensity)},
                         {"solid_angle_sr", found.solid_angle_sr},
                         {"surround", found.surround},
                         {"pictures", found.seen.size()},
                         {"residual", found.residual},
                         {"by", found.by_surface ? "surface" : "triangulation"}};
  json["sigma_mm"] = numbers(Vector3d(1e3 * found.covariance.diagonal().cwiseSqrt()));
  if (found.direction) json["direction"] = numbers(*found.direction);
  return json;
}

nlohmann::json light_json(const estimation::Estimate<lights::RoomLight>& light) {
  if (!light.usable()) return {{"intensity", "assumed"}, {"reason", light.verdict.reason}};
  nlohmann::json sigma = nlohmann::json::array();
  for (Eigen::Index i = 0; i < light.covariance.rows(); ++i)
    sigma.push_back(std::sqrt(light.covariance(i, i)));
  return {{"intensity", "measured"},
          {"ambient", numbers(light.value.ambient)},
          {"sigma_share", sigma},
          {"largest_share", light.value.largest_share},
          {"residual", light.value.residual},
          {"samples", light.value.samples},
          {"planes", light.value.planes}};
}

nlohmann::json rejected_json(const lights::RejectedLamp& rejected) {
  nlohmann::json json = {{"reason", lights::name(rejected.refusal)},
                         {"text", lights::text_of(rejected.refusal)},
                         {"position_m", nullptr},
                         {"from_m", numbers(rejected.from_m)},
                         {"ray", numbers(rejected.ray)},
                         {"surround", rejected.surround},
                         {"pictures", rejected.seen.size()}};
  if (rejected.position_m) json["position_m"] = numbers(*rejected.position_m);
  return json;
}

}  // namespace

Result<RoomLights> find_lights(const LightsOptions& options) {
  if (options.take.empty() && options.room.empty())
    return Error{ErrorCode::kUsage, "lights: give --take, --model, or both: whose lamps?"};
  if (options.take.empty() && !options.bracket.empty())
    return Error{ErrorCode::kUsage, "lights: --bracket needs --take: whose fisheye took it?"};
  MIXRIG_ASSIGN(const auto room, room_of(options));
  RoomLights found;
  if (options.take.empty()) {
    MIXRIG_TRY(add_lights_of_room(options, *room, found));
  } else {
    MIXRIG_ASSIGN(found, lights_of_take(options, room ? &*room : nullptr));
  }
  if (room) measure(*room, options.exposure, found);
  found.lamps = scene_lamps(found.search);
  if (found.light.usable())
    take_intensity(found, found.lamps);
  else
    assume_intensity(found, found.lamps);
  return found;
}

nlohmann::json to_json(const RoomLights& found) {
  nlohmann::json lamps = nlohmann::json::array(), rejected = nlohmann::json::array();
  for (std::size_t i = 0; i < found.lamps.size(); ++i) {
    lamps.push_back(lamp_json(found.search.lamps[i], found.lamps[i]));
    if (!found.radiance.empty()) lamps.back()["radiance"] = found.radiance[i];
  }
  for (const auto& r : found.search.rejected) rejected.push_back(rejected_json(r));
  return {{"lamps", lamps},
          {"rejected", rejected},
          {"light", light_json(found.light)},
          {"pictures", found.pictures},
          {"without_pose", found.without_pose}};
}

Result<void> write_lights(const RoomLights& found, const fs::path& scene) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20;
  MIXRIG_ASSIGN(const std::string text, config::read_text(scene, kMostBytes));
  std::optional<Eigen::Vector3f> ambient;
  if (found.light.usable()) ambient = found.light.value.ambient;
  MIXRIG_ASSIGN(const std::string edited, scene::with_lamps(text, scene, found.lamps, ambient));
  return write_file(scene, edited);
}

}  // namespace mixrig::session
