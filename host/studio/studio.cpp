// SPDX-License-Identifier: Apache-2.0
// The virtual studio: scenes, cameras and their pictures, frame by frame.
#include "host/studio/studio.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "host/studio/light/object_gloss.h"
#include "host/studio/stage/object.h"
#include "host/studio/studio_state.h"

namespace mixrig::studio {
namespace {

constexpr int kEmptyFrames = 25;
constexpr int kStudioBand = 4;

Result<void> check_place(const StudioOptions& o) {
  const auto in_room = [](const std::optional<Eigen::Vector3d>& at_m) {
    return !at_m || ((at_m->array() > 0.05).all() && at_m->x() < kRoomX_m - 0.05 &&
                     at_m->y() < kRoomY_m - 0.05 && at_m->z() < kRoomZ_m - 0.05);
  };
  if (!in_room(o.eye_m) || !in_room(o.look_at_m))
    return Error{ErrorCode::kUsage,
                 fmt::format("studio: the camera and what it looks at must be in the room of "
                             "{} x {} x {} m, 5 cm off its walls",
                             kRoomX_m, kRoomY_m, kRoomZ_m)};
  if (const auto& at_m = o.object_m;
      at_m && !(at_m->minCoeff() > 0.4 && at_m->x() < kRoomX_m - 0.4 && at_m->y() < kRoomY_m - 0.4))
    return Error{ErrorCode::kUsage,
                 "studio: the object must stand in the room, 0.4 m off its walls"};
  const Layout layout = make_layout(o);
  const Eigen::Vector3d ahead = layout.look_at_m - layout.eye_m;
  if (ahead.cross(Eigen::Vector3d::UnitZ()).norm() < 0.05)
    return Error{
        ErrorCode::kUsage,
        "studio: the camera looks straight up or down, or stands where it looks: move one"};
  return {};
}

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
  if (o.people < 1 || o.people > 3)
    return wrong(fmt::format("people must be 1 to 3, not {}", o.people));
  if (o.scenario == Scenario::kRounds && o.people > 2)
    return wrong("scenario rounds has at most 2 people: a third would stand in the way");
  if (o.day.crowd < 0 || o.day.crowd > 8)
    return wrong(fmt::format("the crowd must be 0 to 8 people, not {}", o.day.crowd));
  if (!(o.day.lamp_level >= 0 && o.day.lamp_level <= 2))
    return wrong(fmt::format("the lamps' level must be 0 to 2, not {}", o.day.lamp_level));
  if (o.day.dim && !(o.day.dim->lamp >= 1 && o.day.dim->lamp <= 4 && o.day.dim->level >= 0 &&
                     o.day.dim->level <= 2))
    return wrong("the lamp to dim must be 1 to 4, its level 0 to 2");
  if (o.day.moved_chair && o.clear_floor)
    return wrong("a clear floor has no chair that could be moved: drop one of the two");
  if (o.scenario == Scenario::kSweep && !o.sweep.views.empty() &&
      (o.sweep.frames_per_view < 1 ||
       static_cast<std::size_t>(o.frames) != o.sweep.views.size() * o.sweep.frames_per_view))
    return wrong("frames of a sweep must be its views times the frames of a view");
  if (!(o.pan_rad >= 0 && o.pan_rad <= 2))
    return wrong(fmt::format("the pan must be 0 to 2 radians to a side, not {}", o.pan_rad));
  for (const int side : {o.fisheye_px.width, o.fisheye_px.height})
    if (side < 64 || side > 4096)
      return wrong(fmt::format("the fisheye must have 64 to 4096 pixels per side, not {}x{}",
                               o.fisheye_px.width, o.fisheye_px.height));
  if (!(o.zoom >= 1 && o.zoom <= 8))
    return wrong(fmt::format("the zoom must be 1 to 8 times, not {}", o.zoom));
  if (o.zoom > 1 && o.scenario == Scenario::kSweep)
    return wrong("a sweep has a fixed lens: leave out the zoom");
  if (o.raw && o.rig != RigPreset::kKinect2)
    return wrong("raw pictures are those of rig kinect2: give --rig kinect2, or leave out --raw");
  if (o.raw && o.second_tof)
    return wrong("raw pictures are those of one depth camera: leave out the second, or --raw");
  if (o.window && o.realism.mirror)
    return wrong("window and mirror have one place: drop one of the two");
  MIXRIG_TRY(check_place(o));
  if (!(o.lens.aperture_m >= 0 && o.lens.aperture_m <= 0.2 && o.lens.focus_m >= 0.1 &&
        o.lens.focus_m <= 100))
    return wrong("the lens must have an aperture of 0 to 200 mm and be sharp at 0.1 to 100 m");
  const Realism& look = o.realism;
  if (o.refocus && !(look.defocus && o.refocus->focus_m >= 0.1 && o.refocus->focus_m <= 100))
    return wrong("a lens that is focused anew needs the look \"defocus\" and 0.1 to 100 m");
  if (o.lens.aperture_m > 0 && (look.bounce || look.gloss || look.mirror || o.props))
    return wrong("the thin lens knows the plain look alone: add --plain, leave out --props");
  if (o.threads < 0 || o.threads > 256)
    return wrong(fmt::format("threads must be 0 to 256, not {}", o.threads));
  return {};
}

int empty_frames_of(const StudioOptions& o) {
  if (o.scenario == Scenario::kSweep) return o.sweep.people ? o.sweep.frames_per_view : o.frames;
  return std::min(kEmptyFrames, o.frames / 2);
}

StudioInfo make_info(const StudioOptions& options, const Layout& layout, const Rig& rig) {
  StudioInfo info;
  info.name = fmt::format("{} {}, {}", name(options.scenario), options.seed, name(options.rig));
  if (options.second_tof) info.name += fmt::format("+{}", name(*options.second_tof));
  info.frames = options.frames;
  info.empty_frames = empty_frames_of(options);
  info.room_m = {kRoomX_m, kRoomY_m, kRoomZ_m};
  info.target = rig.target;
  info.view = without_distortion(info.target);
  info.tof = {rig.tof.optics, rig.tof.target_from_tof, rig.tof.unit_m, rig.tof.noise};
  if (rig.tof2)
    info.tof2 = {rig.tof2->optics, rig.tof2->target_from_tof, rig.tof2->unit_m, rig.tof2->noise};
  describe_fisheye(options, rig, info);
  info.light = layout.light;
  info.object = build_object(layout.world_from_object, options.glossy_object);
  info.capture_volume = capture_volume(layout);
  info.camera_moves = layout.camera_moves;
  info.world_from_rest = rest_pose(layout);
  const bool sweeps = options.scenario == Scenario::kSweep;
  if (sweeps || options.scenario == Scenario::kPan) info.pan_tilt = layout.pan_tilt;
  if (layout.camera_moves && !sweeps && options.scenario != Scenario::kStarts)
    info.mocap = mocap_of_seed(options.seed);
  return info;
}

TofSensor sensor_of(const StudioOptions& o, const Rig& rig) {
  const TofSensor sensor = with_realism(rig.tof, o.rig, o.realism);
  return o.raw ? raw_sensor(sensor) : sensor;
}

Shutter shutter_of(const StudioOptions& o) {
  const ColorSensor sensor;
  return {o.size_px.height, o.realism.motion_blur ? sensor.exposure_s : 0,
          o.realism.rolling_shutter ? sensor.readout_s : 0};
}

}  // namespace

SecondTofCamera::SecondTofCamera(const TofSensor& sensor, unsigned seed, bool raw,
                                 const TraceDevice& device)
    : camera(sensor, seed ^ 0x5EC0D, raw),
      taps{TraceScene(device), TraceScene(device), TraceScene(device), TraceScene(device)} {}

Studio::State::State(const StudioOptions& o, const TraceDevice& device)
    : options(o),
      layout(make_layout(o)),
      rig(rig_of_seed(o.rig, o.seed, o.size_px, o.tolerance, o.second_tof)),
      info(make_info(o, layout, rig)),
      materials(o.seed, choose_wardrobe(o.seed, o.scenario == Scenario::kDark), &info.object),
      lamps(info.light),
      cast(o, layout, info.empty_frames / kFrameRate_hz),
      crew(o.threads),
      room(device),
      furniture(device),
      object(device),
      person(device),
      moment(device),
      taps{TraceScene(device), TraceScene(device), TraceScene(device), TraceScene(device)},
      zoom{info.target, o.zoom},
      plate_rays(info.target),
      view_rays(info.view),
      tof(sensor_of(o, rig), o.seed, o.raw_depth),
      camera(info.target, o.realism, o.seed),
      shutter(shutter_of(o)),
      in_slices(o.realism.motion_blur || o.realism.rolling_shutter) {
  if (o.raw) {
    raw.emplace(tof.sensor(), o.seed);
    info.raw = raw->tables();
  }
  info.tof.delay_s = tof.sensor().delay_s;
  if (rig.tof2) {
    const TofSensor sensor = with_realism(*rig.tof2, *o.second_tof, o.realism);
    tof2 = std::make_unique<SecondTofCamera>(sensor, o.seed, o.raw_depth, device);
    info.tof2->delay_s = sensor.delay_s;
  }
  Mesh mesh = build_room(layout.room);
  Mesh things = furniture_of(mesh);
  room.set(mesh);
  furniture.set(things);
  Mesh statue = object_in_world(info.object);
  object.set(statue);
  Cast::dress(o, materials);
  casters = {&furniture, &object, &person, o.cache, nullptr};
  ambient = info.light.ambient;
  reflector = {&room,  &furniture, &object, &person,         &materials,
               &lamps, ambient,    {},      o.realism.gloss, o.realism.mirror};
  if (o.realism.gloss || o.realism.mirror) casters.reflector = &reflector;
  if (o.realism.bounce) balance_ambient();
  light_now = info.light;
  ambient_lit = ambient, reflected_lit = reflector.ambient;
  materials.set_lamp_level(static_cast<float>(o.day.lamp_level));
}

void Studio::State::set_time(double time_s) {
  const Day& day = options.day;
  if (day.swinging_door) {
    layout.room.door_rad = door_rad(day, time_s);
    Mesh mesh = build_room(layout.room);
    Mesh things = furniture_of(mesh);
    room.set(mesh);
    furniture.set(things);
  }
  const bool on = !day.lights_out_s || time_s < *day.lights_out_s;
  const bool dims = day.dim && time_s >= day.dim->from_s;
  if (on == lights_on && dims == is_dim) return;
  lights_on = on, is_dim = dims;
  has_plate = has_view = false;
  constexpr float kOff = 1e-4F;
  const float level = on ? 1 : kOff;
  const float left = on ? 1 : ambient_share(0) / ambient_share(static_cast<float>(day.lamp_level));
  light_now = info.light;
  for (Panel& lamp : light_now.lamps) lamp.intensity *= level;
  if (dims && day.dim->lamp <= static_cast<int>(light_now.lamps.size()))
    light_now.lamps[static_cast<std::size_t>(day.dim->lamp - 1)].intensity *=
        std::max(kOff, static_cast<float>(day.dim->level));
  light_now.ambient *= left;
  ambient = left * ambient_lit, reflector.ambient = left * reflected_lit;
  lamps = LampSet(light_now);
  materials.set_lamp_level(level * static_cast<float>(day.lamp_level));
}

void Studio::State::balance_ambient() {
  constexpr float kRest = 0.4F;  // windows, and light that was reflected twice and more
  const geometry::Pose pose = rest_pose(layout);
  ambient *= kRest;
  reflector.ambient = ambient;
  BounceCache cache;
  cache.build(reflector, room, camera_rays(view_rays, pose), info.view, pose, false, false, crew);
  info.light.ambient = ambient + cache.mean();
  info.light.by_direction = true;
  reflector.ambient = info.light.ambient;
}

void Studio::State::trace_bounce(const CameraPlace& place) {
  if (!options.realism.bounce) return;
  const CameraRays rays = camera_rays(view_rays, place.world_from_target);
  Reflector r = reflector;
  r.ambient = ambient;
  const bool dense = !info.camera_moves;
  room_bounce.build(r, room, rays, info.view, place.world_from_target, dense, false, crew);
  object_bounce.build(r, object.scene, rays, info.view, place.world_from_target, dense, false,
                      crew);
}

void Studio::State::reflect_static(SurfelMap& map, const BounceCache& bounce, bool with_object) {
  if (options.realism.bounce) bounce_surfels(map, bounce, crew);
  if (casters.reflector != nullptr) mirror_surfels(map, reflector, with_object, crew);
}

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

double Studio::State::people_time_s(double time_s) const {
  if (options.scenario != Scenario::kSweep || options.sweep.views.empty()) return time_s;
  constexpr double kTurn_s = 1.5, kCross_s = 0.7;
  const int frame = static_cast<int>(std::lround(time_s * kFrameRate_hz));
  const int per_view = options.sweep.frames_per_view, stop = frame / per_view;
  if (!options.sweep.crossing) return time_s + kTurn_s * stop;
  const double frame_s = frame / kFrameRate_hz;
  const Eigen::Vector3d right =
      camera_at(layout, options, frame_s).world_from_target.rotation * Eigen::Vector3d::UnitX();
  const bool crosses = stop % 2 == 1 || options.sweep.crossing_all;
  const Eigen::Vector3d ahead = (crosses ? 1 : -1) * Eigen::Vector3d::UnitZ().cross(right);
  return cast.first().time_towards(ahead.x(), ahead.y()) +
         kCross_s * (frame % per_view - 0.5 * (per_view - 1)) + time_s - frame_s;
}

void Studio::State::place_person(int number, double time_s) {
  const bool present = number > info.empty_frames;
  const auto fill = [&](auto& scene, double t) {
    spare.clear();
    if (present) cast.build(people_time_s(t), spare);
    scene.set(spare);
  };
  fill(person, time_s);
  const auto fill_taps = [&](const TofSensor& sensor, std::array<TraceScene, 4>& of_camera) {
    for (int k = 0; k < 4; ++k)
      fill(of_camera[k], time_s + sensor.delay_s + (k - 1.5) / 4 * sensor.exposure_s);
  };
  fill_taps(tof.sensor(), taps);
  if (tof2) fill_taps(tof2->camera.sensor(), tof2->taps);
}

void Studio::State::fill_person(Occluder& scene, double time_s) {
  spare.clear();
  cast.build(people_time_s(time_s), spare);
  scene.set(spare);
}

void Studio::State::trace_static(const CameraPlace& place, double time_s, bool with_truth) {
  const bool keep = options.cache && !info.camera_moves && !options.day.changes();
  const Rect all{0, 0, options.size_px.width, options.size_px.height};
  if (!has_plate || !keep) {
    trace_tof(time_s, info.tof.target_from_tof, tof, tof_at);
    if (tof2) trace_tof(time_s, info.tof2->target_from_tof, tof2->camera, tof2->place);
    plate.room.build(room, materials, camera_rays(plate_rays, place.world_from_target), all, crew);
    light_surfels(plate.room, lamps, casters, false, false, crew);
    reflector.eye = place.world_from_target.translation_m.cast<float>();
    trace_bounce(place);
    reflect_static(plate.room, room_bounce, false);
    has_plate = true, has_view = has_view && keep;
  }
  if (!with_truth || (has_view && keep)) return;
  const CameraRays rays = camera_rays(view_rays, place.world_from_target);
  view.room.build(room, materials, rays, all, crew);
  light_surfels(view.room, lamps, casters, true, false, crew);
  reflect_static(view.room, room_bounce, true);
  view.object.build(object.scene, materials, rays,
                    covered_by(object.scene.mesh(), info.view, place.world_from_target), crew);
  light_surfels(view.object, lamps, casters, true, false, crew);
  if (options.realism.bounce) bounce_surfels(view.object, object_bounce, crew);
  if (options.glossy_object) {
    Reflector r = reflector;
    r.ambient = ambient;
    gloss_object(view.object, r, lamps, info.object, options.realism.bounce, crew);
  }
  find_room_seen(rays, info.tof.optics, tof_at);
  if (tof2) find_room_seen(rays, info.tof2->optics, tof2->place);
  has_view = true;
}

void Studio::State::trace_tof(double time_s, const geometry::Pose& target_from_tof, TofCamera& of,
                              TofPlace& at) {
  const geometry::Pose world_from_tof =
      camera_at(layout, options, time_s).world_from_target * target_from_tof;
  const geometry::Pose later =
      camera_at(layout, options, time_s + of.sensor().delay_s).world_from_target;
  at.eye_m = world_from_tof.translation_m;
  at.tof_from_world = geometry::inverse(world_from_tof);
  of.trace_room(room, materials, later * target_from_tof, crew);
}

void Studio::State::find_room_seen(const CameraRays& rays, const Optics& optics, TofPlace& at) {
  at.sees_room.reset(options.size_px);
  crew.rows(options.size_px.height, kStudioBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < options.size_px.width; ++x) {
        const float z = view.room.centre_z(x, y);
        const Vec3 point =
            rays.position + z * rays.direction(static_cast<float>(x), static_cast<float>(y));
        at.sees_room.at(x, y) = z < kMiss && visible_to_tof(at, optics, point, room) ? 1 : 0;
      }
  });
}

void Studio::State::set_lens(double time_s) {
  if (options.zoom == 1) return;
  const LensSetting at = lens_at(info, time_s);
  const Optics optics = zoom.optics(at);
  const bool same = optics.fx_px == info.target.fx_px && optics.cx_px == info.target.cx_px &&
                    pupil_shift_m == zoom.pupil_shift_m(at);
  if (same) return;
  has_plate = has_view = false;
  info.target = optics;
  info.view = without_distortion(info.target);
  pupil_shift_m = zoom.pupil_shift_m(at);
  plate_rays = RayGrid(info.target), view_rays = RayGrid(info.view);
  camera = ColorCamera(info.target, options.realism, options.seed);
}

CameraPlace Studio::State::eye_at(double time_s) const {
  CameraPlace place = camera_at(layout, options, time_s);
  place.world_from_target.translation_m +=
      place.world_from_target.rotation * Eigen::Vector3d(0, 0, pupil_shift_m);
  return place;
}

void Studio::State::bounce_on_person(const CameraPlace& place) {
  if (!options.realism.bounce) return;
  Reflector r = reflector;
  r.ambient = ambient;
  person_bounce.build(r, person.scene, camera_rays(view_rays, place.world_from_target), info.view,
                      place.world_from_target, true, true, crew);
}

void Studio::State::trace_person(const CameraPlace& place, const RayGrid& rays,
                                 const Optics& optics, SceneSurfels& surfels, bool with_object) {
  const Rect rect = covered_by(person.scene.mesh(), optics, place.world_from_target);
  const std::vector<std::uint8_t> thin =
      touched_by_thin(person.scene.mesh(), optics, place.world_from_target, rect);
  surfels.person.build(person.scene, materials, camera_rays(rays, place.world_from_target), rect,
                       crew, &thin);
  light_surfels(surfels.person, lamps, casters, with_object, true, crew);
  if (options.realism.bounce) bounce_surfels(surfels.person, person_bounce, crew);
  if (options.props && casters.reflector != nullptr)
    mirror_surfels(surfels.person, reflector, with_object, crew);
}

void Studio::room_distances(const geometry::Pose& world_from_eye, Image<float>& distance_m) const {
  const Vec3 eye = world_from_eye.translation_m.cast<float>();
  const Size size = distance_m.size();
  state_->crew.rows(size.height, kStudioBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / size.width);
        const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / size.height);
        const Eigen::Vector3d ray(-std::sin(azimuth) * std::cos(elevation),
                                  std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
        Hit hit;
        const bool met =
            state_->room.intersect(eye, (world_from_eye.rotation * ray).cast<float>(), kMiss, hit);
        distance_m.at(x, y) = met ? hit.t : 0;
      }
  });
}

void Studio::set_exposure(double factor) { state_->exposed_by = static_cast<float>(factor); }

void Studio::turn_head(const HeadMotion& motion) { state_->options.sweep.moved = motion; }

void Studio::State::place_people_truth(double time_s, Truth& truth) {
  const double at_s = people_time_s(time_s);
  for (const PersonMotion& motion : cast.people()) {
    const Vec3 pelvis = motion.at(at_s).pelvis;
    truth.people.push_back({{pelvis.x(), pelvis.y()}});
  }
  const Mesh& mesh = person.scene.mesh();
  for (std::size_t t = 0; t < mesh.materials.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      double& top_m = truth.people[mesh.materials[t].person].top_m;
      top_m = std::max<double>(top_m, mesh.positions[mesh.indices[3 * t + k]].z());
    }
  const Rect& rect = view.person.rect();
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      const float z = view.person.centre_z(x, y);
      if (!(z < view.room.centre_z(x, y))) continue;
      const std::span<const Surfel> seen = std::as_const(view.person).at(x, y);
      if (seen.empty()) continue;  // a strand that no sub-sample meets
      const auto nearest = std::min_element(
          seen.begin(), seen.end(), [](const Surfel& a, const Surfel& b) { return a.z < b.z; });
      truth.people[nearest->person].visible_m2 += z * z / (info.view.fx_px * info.view.fy_px);
    }
}

void Studio::render(int number, Frame& frame, Truth* truth) {
  State& s = *state_;
  frame.number = number;
  frame.time_s = (number - 1) / kFrameRate_hz;
  s.options.sweep.moved_s = frame.time_s;
  s.set_time(frame.time_s);
  s.set_lens(frame.time_s);
  const CameraPlace place = s.eye_at(frame.time_s);
  frame.world_from_target = camera_at(s.layout, s.options, frame.time_s).world_from_target;
  frame.head = place.head;
  s.place_person(number, frame.time_s);
  s.trace_static(place, frame.time_s, truth != nullptr);
  s.bounce_on_person(place);
  s.trace_person(place, s.plate_rays, s.info.target, s.plate, false);
  if (s.options.realism.shows_in_the_plate()) {
    s.expose_plate(place, frame.time_s);
    for (int y = 0; s.exposed_by != 1 && y < s.exposed.height(); ++y)
      std::transform(s.exposed.row(y), s.exposed.row(y) + s.exposed.width(), s.exposed.row(y),
                     [&](const Rgbf& c) {
                       return Rgbf{s.exposed_by * c.r, s.exposed_by * c.g, s.exposed_by * c.b};
                     });
    if (const auto& to = s.options.refocus)
      s.camera.set_focus(frame.time_s >= to->from_s ? static_cast<float>(to->focus_m)
                                                    : ColorSensor{}.focus_m);
    s.camera.develop(s.exposed, s.plate_z_m, s.noise_number(number), frame.time_s, s.crew,
                     frame.color);
  } else {
    s.draw_color(frame);
  }
  const TofCamera::Shot shot{s.taps, &s.person, &s.room, number, frame.time_s};
  if (s.raw)
    s.tof.render_raw(shot, s.materials, s.crew, *s.raw, frame.raw, frame.tof_true_m);
  else
    s.tof.render(shot, s.materials, s.crew, frame.tof_distance_m, frame.tof_amplitude);
  if (s.tof2)
    s.tof2->camera.render({s.tof2->taps, &s.person, &s.room, number, frame.time_s}, s.materials,
                          s.crew, frame.tof2_distance_m, frame.tof2_amplitude);
  if (truth == nullptr) return;
  s.trace_person(place, s.view_rays, s.info.view, s.view, true);
  s.draw_truth(place, *truth);
  if (s.options.lens.aperture_m > 0) s.draw_through_lens(place, truth->composite);
  truth->view.reset();
  if (s.options.zoom > 1) truth->view = s.info.view;
  truth->pupil_shift_m = s.pupil_shift_m;
  truth->people.clear();
  if (number > s.info.empty_frames) s.place_people_truth(frame.time_s, *truth);
}

}  // namespace mixrig::studio
