// SPDX-License-Identifier: Apache-2.0
// The virtual studio: scenes, cameras and their pictures, frame by frame.
#include "host/studio/studio.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/studio/rig_of_seed.h"
#include "host/studio/sensors/fisheye.h"
#include "host/studio/sensors/picture.h"
#include "host/studio/sensors/tof_camera.h"
#include "host/studio/srgb.h"
#include "host/studio/stage/layout.h"
#include "host/studio/stage/object.h"
#include "host/studio/stage/person.h"

namespace mixrig::studio {
namespace {

constexpr int kEmptyFrames = 25;
constexpr int kBand = 4;
constexpr float kFullWell_e = 12000, kReadNoise_e = 8;  ///< colour sensor at exposure 1

Result<void> check(const StudioOptions& o) {
  const auto wrong = [](std::string what) {
    return Error{ErrorCode::kUsage, "studio: " + std::move(what)};
  };
  if (o.frames < 2 || o.frames > 100000)
    return wrong(fmt::format("frames must be 2 to 100000, not {}", o.frames));
  if (!(o.tolerance >= 0 && o.tolerance <= 2))
    return wrong(fmt::format("tolerance must be 0 to 2, not {}", o.tolerance));
  for (const int side : {o.size_px.width, o.size_px.height})
    if (side < 32 || side > 4096)
      return wrong(fmt::format("size must be 32 to 4096 pixels per side, not {}x{}",
                               o.size_px.width, o.size_px.height));
  if (o.threads < 0 || o.threads > 256)
    return wrong(fmt::format("threads must be 0 to 256, not {}", o.threads));
  return {};
}

StudioInfo make_info(const StudioOptions& options, const Layout& layout, const Rig& rig) {
  StudioInfo info;
  info.name = fmt::format("{} {}, {}", name(options.scenario), options.seed, name(options.rig));
  info.frames = options.frames;
  info.empty_frames = std::min(kEmptyFrames, options.frames / 2);
  info.target = rig.target;
  info.view = without_distortion(info.target);
  info.tof = {rig.tof.optics, rig.tof.target_from_tof, rig.tof.unit_m, rig.tof.noise};
  info.fisheye = {rig.fisheye, rig.target_from_fisheye};
  info.light = layout.light;
  info.object = build_object(layout.world_from_object);
  info.capture_volume = capture_volume(layout);
  info.camera_moves = layout.camera_moves;
  info.world_from_rest = rest_pose(layout);
  if (options.scenario == Scenario::kPan) info.pan_tilt = layout.pan_tilt;
  if (layout.camera_moves) info.mocap = mocap_of_seed(options.seed);
  return info;
}

}  // namespace

struct Studio::State {
  State(const StudioOptions& o, const TraceDevice& device)
      : options(o),
        layout(make_layout(o)),
        rig(rig_of_seed(o.rig, o.seed, o.size_px, o.tolerance)),
        info(make_info(o, layout, rig)),
        materials(o.seed, choose_wardrobe(o.seed, o.scenario == Scenario::kDark), &info.object),
        lamps(info.light),
        motion(o.scenario, o.seed, layout.stage, info.empty_frames / kFrameRate_hz),
        crew(o.threads),
        room(device),
        furniture(device),
        object(device),
        person(device),
        taps{TraceScene(device), TraceScene(device), TraceScene(device), TraceScene(device)},
        plate_rays(info.target),
        view_rays(info.view),
        tof(rig.tof, o.seed, o.raw_depth) {
    Mesh mesh = build_room(layout.room);
    Mesh things = furniture_of(mesh);
    room.set(mesh);
    furniture.set(things);
    Mesh statue = object_in_world(info.object);
    object.set(statue);
    casters = {&furniture, &object, &person, o.cache};
  }

  /// Builds the person of a frame: at mid-exposure and at the times of the four ToF taps.
  void place_person(int number, double time_s);
  /// Traces and lights the parts that do not move, unless they are cached.
  void trace_static(const CameraPlace& place, bool with_truth);
  void trace_person(const CameraPlace& place, const RayGrid& rays, const Optics& optics,
                    SceneSurfels& surfels, bool with_object);
  void draw_color(Frame& frame);
  void draw_truth(const CameraPlace& place, Truth& truth);
  bool visible_to_tof(const Vec3& point, const TraceScene& scene) const;

  StudioOptions options;
  Layout layout;
  Rig rig;
  StudioInfo info;
  Materials materials;
  LampSet lamps;
  PersonMotion motion;
  Crew crew;
  TraceScene room;
  Occluder furniture, object, person;
  std::array<TraceScene, 4> taps;
  ShadowCasters casters;
  RayGrid plate_rays, view_rays;
  TofCamera tof;
  SceneSurfels plate, view;
  bool has_plate = false, has_view = false;
  Image<std::uint8_t> room_visible;  ///< room surfaces visible to the ToF camera, without people
  Eigen::Vector3d tof_eye_m;
  geometry::Pose tof_from_world;
  NormalTable normal;
  Mesh spare;  ///< reused memory
};

Studio::Studio(std::unique_ptr<State> state) : state_(std::move(state)) {}
Studio::Studio(Studio&&) noexcept = default;
Studio& Studio::operator=(Studio&&) noexcept = default;
Studio::~Studio() = default;

Result<Studio> Studio::create(const StudioOptions& options) {
  MIXRIG_TRY(check(options));
  MIXRIG_ASSIGN(const TraceDevice device, TraceDevice::create());
  return Studio(std::make_unique<State>(options, device));
}

const StudioInfo& Studio::info() const { return state_->info; }

void Studio::State::place_person(int number, double time_s) {
  const bool present = number > info.empty_frames;
  const auto fill = [&](auto& scene, double t) {
    spare.clear();
    if (present) build_person(motion.build(), motion.at(t), spare);
    scene.set(spare);
  };
  fill(person, time_s);
  for (int k = 0; k < 4; ++k) fill(taps[k], time_s + (k - 1.5) / 4 * tof.sensor().exposure_s);
}

void Studio::State::trace_static(const CameraPlace& place, bool with_truth) {
  const bool keep = options.cache && !info.camera_moves;
  const Rect all{0, 0, options.size_px.width, options.size_px.height};
  if (!has_plate || !keep) {
    const geometry::Pose world_from_tof = place.world_from_target * info.tof.target_from_tof;
    tof_eye_m = world_from_tof.translation_m;
    tof_from_world = geometry::inverse(world_from_tof);
    tof.trace_room(room, materials, world_from_tof, crew);
    plate.room.build(room, materials, camera_rays(plate_rays, place.world_from_target), all, crew);
    light_surfels(plate.room, lamps, casters, false, false, crew);
    has_plate = true, has_view = has_view && keep;
  }
  if (!with_truth || (has_view && keep)) return;
  const CameraRays rays = camera_rays(view_rays, place.world_from_target);
  view.room.build(room, materials, rays, all, crew);
  light_surfels(view.room, lamps, casters, true, false, crew);
  view.object.build(object.scene, materials, rays,
                    covered_by(object.scene.mesh(), info.view, place.world_from_target), crew);
  light_surfels(view.object, lamps, casters, true, false, crew);
  room_visible.reset(options.size_px);
  crew.rows(all.y1, kBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < all.x1; ++x) {
        const float z = view.room.centre_z(x, y);
        const Vec3 point =
            rays.position + z * rays.direction(static_cast<float>(x), static_cast<float>(y));
        room_visible.at(x, y) = z < kMiss && visible_to_tof(point, room) ? 1 : 0;
      }
  });
  has_view = true;
}

void Studio::State::trace_person(const CameraPlace& place, const RayGrid& rays,
                                 const Optics& optics, SceneSurfels& surfels, bool with_object) {
  const Rect rect = covered_by(person.scene.mesh(), optics, place.world_from_target);
  surfels.person.build(person.scene, materials, camera_rays(rays, place.world_from_target), rect,
                       crew);
  light_surfels(surfels.person, lamps, casters, with_object, true, crew);
}

/// True if the point projects into the ToF picture and nothing of `scene` occludes it.
bool Studio::State::visible_to_tof(const Vec3& point, const TraceScene& scene) const {
  const Eigen::Vector3d in_tof = tof_from_world * point.cast<double>();
  if (in_tof.z() < 0.05) return false;
  const Optics& optics = info.tof.optics;
  if (std::abs(in_tof.x()) > 1.2 * in_tof.z() || std::abs(in_tof.y()) > 1.2 * in_tof.z())
    return false;
  const Eigen::Vector2d px = project(optics, in_tof);
  if (px.x() < 0 || px.y() < 0 || px.x() > optics.size_px.width - 1 ||
      px.y() > optics.size_px.height - 1)
    return false;
  const Vec3 eye = tof_eye_m.cast<float>();
  const Vec3 towards = eye - point;
  return !scene.blocked(point + 3e-3F * towards.normalized(), eye);
}

void Studio::State::draw_color(Frame& frame) {
  frame.color.reset(options.size_px);
  const auto exposure = static_cast<float>(info.light.exposure);
  crew.rows(options.size_px.height, kBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < options.size_px.width; ++x) {
        const Vec3 light =
            exposure * compose_pixel(plate, x, y, lamps, info.light.ambient, casters, false).real;
        const std::uint64_t pixel =
            static_cast<std::uint64_t>(y) * 65536 + static_cast<unsigned>(x);
        const std::uint64_t bits = hash_key(hash_key(options.seed, 0xC0102),
                                            static_cast<std::uint64_t>(frame.number), pixel);
        Vec3 noisy;
        for (int c = 0; c < 3; ++c) {
          const float charge = kFullWell_e * light[c];
          noisy[c] = (charge +
                      std::sqrt(charge + kReadNoise_e * kReadNoise_e) * normal(bits >> (12 * c))) /
                     kFullWell_e;
        }
        frame.color.at(x, y) = srgb_from_linear(noisy);
      }
  });
}

void Studio::State::draw_truth(const CameraPlace& place, Truth& truth) {
  const Size size = options.size_px;
  truth.depth_m.reset(size), truth.background_depth_m.reset(size), truth.matte.reset(size);
  truth.light.reset(size), truth.composite.reset(size), truth.labels.reset(size);
  const CameraRays rays = camera_rays(view_rays, place.world_from_target);
  const auto exposure = static_cast<float>(info.light.exposure);
  crew.rows(size.height, kBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Pixel p = compose_pixel(view, x, y, lamps, info.light.ambient, casters, true);
        const float behind = view.room.centre_z(x, y), before = view.person.centre_z(x, y);
        const float z = std::min(behind, before);
        const Vec3 point =
            rays.position + z * rays.direction(static_cast<float>(x), static_cast<float>(y));
        const bool room_clear =
            before < behind ? visible_to_tof(point, room) : room_visible.at(x, y) != 0;
        const bool seen =
            room_clear && (person.scene.empty() || visible_to_tof(point, person.scene));
        truth.depth_m.at(x, y) = z < kMiss ? z : 0;
        truth.background_depth_m.at(x, y) = behind < kMiss ? behind : 0;
        truth.matte.at(x, y) = static_cast<std::uint8_t>(std::lround(255 * p.person));
        truth.light.at(x, y) = p.light;
        truth.composite.at(x, y) = srgb_from_linear(Vec3(exposure * p.mixed));
        truth.labels.at(x, y) =
            static_cast<std::uint8_t>(p.layer | (seen ? Truth::kTofSees : 0) |
                                      (p.silhouette >= 0.5F ? Truth::kSilhouette : 0));
      }
  });
}

void Studio::render(int number, Frame& frame, Truth* truth) {
  State& s = *state_;
  frame.number = number;
  frame.time_s = (number - 1) / kFrameRate_hz;
  const CameraPlace place = camera_at(s.layout, s.options, frame.time_s);
  frame.world_from_target = place.world_from_target;
  frame.head = place.head;
  s.place_person(number, frame.time_s);
  s.trace_static(place, truth != nullptr);
  s.trace_person(place, s.plate_rays, s.info.target, s.plate, false);
  s.draw_color(frame);
  s.tof.render(s.taps, s.materials, number, s.crew, frame.tof_distance_m, frame.tof_amplitude);
  if (s.options.fisheye)
    draw_fisheye(s.info.fisheye.optics,
                 place.world_from_target * s.info.fisheye.target_from_fisheye, s.room, s.casters,
                 s.materials, s.lamps, s.info.light, s.crew, frame.fisheye);
  if (truth == nullptr) return;
  s.trace_person(place, s.view_rays, s.info.view, s.view, true);
  s.draw_truth(place, *truth);
  truth->person_on_floor_m.reset();
  if (number > s.info.empty_frames) {
    const Vec3 pelvis = s.motion.at(frame.time_s).pelvis;
    truth->person_on_floor_m = Eigen::Vector2d(pelvis.x(), pelvis.y());
  }
}

}  // namespace mixrig::studio
