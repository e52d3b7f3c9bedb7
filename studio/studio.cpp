// SPDX-License-Identifier: Apache-2.0
// The virtual studio: scenes, cameras and their pictures, frame by frame.
#include "studio/studio.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "studio/stage/object.h"
#include "studio/studio_options.h"
#include "studio/studio_state.h"

namespace mixrig::studio {
namespace {

constexpr int kStudioBand = 4;

StudioInfo make_info(const StudioOptions& options, const Layout& layout, const Rig& rig) {
  StudioInfo info;
  info.name = fmt::format("{} {}, {}", name(options.scenario), options.seed, name(options.rig));
  if (options.second_tof) info.name += fmt::format("+{}", name(*options.second_tof));
  info.frames = options.frames;
  info.empty_frames = empty_frames(options);
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
  if (sweeps || options.scenario == Scenario::kPan || options.scenario == Scenario::kShot)
    info.pan_tilt = layout.pan_tilt;
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

Studio::Studio(std::unique_ptr<State> state) : state_(std::move(state)) {}
Studio::Studio(Studio&&) noexcept = default;
Studio& Studio::operator=(Studio&&) noexcept = default;
Studio::~Studio() = default;

Result<Studio> Studio::create(const StudioOptions& options) {
  MIXRIG_TRY(check_studio_options(options));
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
  const bool crosses = stop % 2 == 1;
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
