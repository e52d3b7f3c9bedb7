// SPDX-License-Identifier: Apache-2.0
// Layout and camera motion of each scenario.
#include "studio/stage/layout.h"

#include <cmath>

#include "hal/base/angles.h"
#include "studio/rig_of_seed.h"
#include "studio/sensors/noise.h"

namespace mixrig::studio {
namespace {

/// Level of a lamp that is off; above 0, so that the shares of the lamps stay defined.
constexpr float kLeastLamps = 1e-4F;
constexpr int kEmptyFrames = 25;
constexpr double kWanderSigma = 0.352;  // of wander(): uniform values, interpolated twice

Light make_light(bool dim, float lamp_level) {
  Light light;
  const float level = dim ? 0.35F : 1.0F;
  light.ambient = level * ambient_share(lamp_level) * Eigen::Vector3f(0.13F, 0.135F, 0.145F);
  light.exposure = 1.1;
  light.lamps = ceiling_lamps(level * std::max(lamp_level, kLeastLamps));
  return light;
}

/// The head pans to both sides, at up to 30 degrees a second, and nods. The encoders report the
/// nearest step; they do not see the play of the axes, whose sigma is the repeatability.
CameraPlace swept(const geometry::Pose& rest, const PanTiltUnit& unit, double pan_rad,
                  double time_s, unsigned seed) {
  constexpr double kPeriodPerRad_s = 12;  // 30 degrees a second in the middle
  const double pan =
      pan_rad > 0 ? pan_rad * std::sin(2 * kPi * time_s / (kPeriodPerRad_s * pan_rad)) : 0;
  const double tilt = 0.04 * (1 - std::cos(2 * kPi * time_s / 4.0));
  const auto play = [&](unsigned salt) {
    const float t = 5 * static_cast<float>(time_s);
    return unit.repeatability_rad / kWanderSigma * wander(t, seed + salt);
  };
  return {rest * rest_from_turned(unit, pan + play(301), tilt + play(302)),
          HeadAngles{whole_steps(unit, pan), whole_steps(unit, tilt)}};
}

/// Share of the way that something has gone at part t of its time: at rest before and after.
double eased(double t) { return 0.5 * (1 - std::cos(kPi * std::clamp(t, 0.0, 1.0))); }

/// The head turns to one side and back while the room is empty, stands, and turns there again. The
/// play of the axes belongs to the place where the head stands.
CameraPlace panned(const geometry::Pose& rest, const PanTiltUnit& unit,
                   const StudioOptions& options, double time_s) {
  constexpr double kTurnsAt = 0.7, kTurns = 0.2;  // parts of the take
  const double there = 2 * time_s * kFrameRate_hz / empty_frames(options);
  const double again = (time_s * kFrameRate_hz / options.frames - kTurnsAt) / kTurns;
  const double pan = options.pan_rad * (there < 1 ? eased(there) : eased(2 - there) + eased(again));
  constexpr float kPlayPerRad = 100;
  const auto play = [&](unsigned salt) {
    return unit.repeatability_rad / kWanderSigma *
           wander(kPlayPerRad * static_cast<float>(pan), options.seed + salt);
  };
  return {rest * rest_from_turned(unit, pan + play(301), play(302)),
          HeadAngles{whole_steps(unit, pan), whole_steps(unit, 0)}};
}

/// The head stands still at each view, at a whole step, but for the play of its axes.
CameraPlace at_view(const geometry::Pose& rest, const PanTiltUnit& unit, const Sweep& sweep,
                    double time_s, unsigned seed) {
  const auto frame = static_cast<std::size_t>(std::lround(std::max(0.0, time_s) * kFrameRate_hz));
  const std::size_t view =
      std::min(frame / static_cast<std::size_t>(sweep.frames_per_view), sweep.views.size() - 1);
  const HeadAngles head{whole_steps(unit, sweep.views[view].pan_rad),
                        whole_steps(unit, sweep.views[view].tilt_rad)};
  const auto play = [&](std::uint64_t salt) {  // uniform, of sigma repeatability
    return std::sqrt(12.0) * unit.repeatability_rad *
           (uniform(hash_key(seed + salt, 0x5EE9, view)) - 0.5);
  };
  return {rest * rest_from_turned(unit, head.pan_rad + play(1), head.tilt_rad + play(2)), head};
}

/// The head as it was moved, at its rate around the time of the frame; the encoders report whole
/// steps. The play of the axes belongs to the place where the head stands.
CameraPlace as_moved(const geometry::Pose& rest, const PanTiltUnit& unit, const Sweep& sweep,
                     double time_s, unsigned seed) {
  const HeadMotion& moved = sweep.moved;
  const double since_s = time_s - sweep.moved_s;
  const double pan = moved.angles.pan_rad + moved.rate_rad_s.pan_rad * since_s;
  const double tilt = moved.angles.tilt_rad + moved.rate_rad_s.tilt_rad * since_s;
  const HeadAngles head{whole_steps(unit, pan), whole_steps(unit, tilt)};
  const auto steps = [&](double angle_rad) {
    return static_cast<std::uint64_t>(std::llround(angle_rad / unit.step_rad) + 100'000);
  };
  const std::uint64_t place =
      1'000'000 * steps(moved.angles.pan_rad) + steps(moved.angles.tilt_rad);
  const auto play = [&](std::uint64_t salt) {  // uniform, of sigma repeatability
    return std::sqrt(12.0) * unit.repeatability_rad *
           (uniform(hash_key(seed + salt, 0x5EE9, place)) - 0.5);
  };
  return {rest * rest_from_turned(unit, pan + play(1) + moved.swing_rad, tilt + play(2)), head};
}

geometry::Pose shaken(const geometry::Pose& rest, float t, unsigned seed) {
  const auto walk = [&](unsigned salt, double size, float rate) {
    return size * (wander(rate * t, seed + salt) - wander(0, seed + salt));
  };
  const Eigen::Vector3d turn(walk(201, 0.03, 0.9F), walk(202, 0.04, 0.8F), walk(203, 0.015, 0.7F));
  const double angle = turn.norm();
  const Eigen::AngleAxisd about(
      angle, angle > 0 ? Eigen::Vector3d(turn / angle) : Eigen::Vector3d(Eigen::Vector3d::UnitX()));
  const Eigen::Vector3d move(walk(204, 0.06, 0.6F), walk(205, 0.04, 0.7F), walk(206, 0.06, 0.5F));
  return rest * geometry::Pose{Eigen::Quaterniond(about), move};
}

/// A pendulum of 0.9 m that swings sideways.
geometry::Pose swung(const geometry::Pose& rest, double time_s) {
  constexpr double kLength_m = 0.9;
  const double angle = 0.16 * std::sin(time_s * std::sqrt(9.81 / kLength_m));
  const Eigen::Vector3d pivot(0, -kLength_m, 0);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  return rest * geometry::Pose{turn, pivot - turn * pivot};
}

/// Hands carry the rig a metre to and fro, ahead and up, and turn it about all axes, by 30 degrees
/// from side to side; they shake.
geometry::Pose carried(const geometry::Pose& rest, double time_s, unsigned seed) {
  const auto wave = [&](double period_s) { return std::sin(2 * kPi * time_s / period_s); };
  const Eigen::Vector3d move(0.5 * wave(7.3), 0.12 * wave(4.1), 0.2 * (1 - std::cos(time_s)));
  const Eigen::Quaterniond turn = Eigen::AngleAxisd(0.26 * wave(5.3), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(0.18 * wave(3.7), Eigen::Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(0.2 * wave(4.7), Eigen::Vector3d::UnitZ());
  return shaken(rest * geometry::Pose{turn, move}, static_cast<float>(time_s), seed);
}

/// Another pose in each frame: places evenly in a ball of 1 m, as far as they are 0.2 m off the
/// walls and 0.4 m above the floor; turns of evenly 0 to 60 degrees about any axis.
geometry::Pose thrown(const geometry::Pose& rest, double time_s, unsigned seed) {
  constexpr double kMost_rad = 60 * kDeg;
  const auto frame =
      static_cast<std::uint64_t>(std::llround(std::max(0.0, time_s) * kFrameRate_hz));
  std::uint64_t next = 0;
  const auto in_ball = [&] {
    for (;;) {
      const auto number = [&] {
        return 2.0 * uniform(hash_key(seed, 0x57A7, 4096 * frame + next++)) - 1;
      };
      const double x = number(), y = number(), z = number();
      if (const Eigen::Vector3d v(x, y, z); v.squaredNorm() <= 1 && v.squaredNorm() > 1e-4)
        return v;
    }
  };
  const Eigen::Vector3d room(kRoomX_m, kRoomY_m, kRoomZ_m), off(0.2, 0.2, 0.4);
  Eigen::Vector3d place;
  do place = rest.translation_m + in_ball();
  while (!(place.array() > off.array() && (room - place).array() > 0.2).all());
  const double angle = kMost_rad * uniform(hash_key(seed, 0x57A8, frame));
  const Eigen::AngleAxisd turn(angle, in_ball().normalized());
  return {rest.rotation * Eigen::Quaterniond(turn), place};
}

}  // namespace

int empty_frames(const StudioOptions& o) {
  if (o.scenario == Scenario::kSweep) return o.sweep.people ? o.sweep.frames_per_view : o.frames;
  return std::min(kEmptyFrames, o.frames / 2);
}

float ambient_share(float lamp_level) {
  constexpr float kOfWindows = 0.15F;
  return kOfWindows + (1 - kOfWindows) * lamp_level;
}

float door_rad(const Day& day, double time_s) {
  constexpr double kPeriod_s = 6, kWide_rad = 75 * kDeg;
  if (!day.swinging_door) return 0;
  return static_cast<float>(0.5 * kWide_rad * (1 - std::cos(2 * kPi * time_s / kPeriod_s)));
}

Layout make_layout(const StudioOptions& options) {
  Layout layout;
  const Scenario scenario = options.scenario;
  const bool narrow = options.rig == RigPreset::kSr3000;
  // The SR3000 rig has a narrow field of view; from this position it sees whole people.
  layout.eye_m = narrow ? Eigen::Vector3d(0.22, 1.35, 1.42) : Eigen::Vector3d(0.22, 2.0, 1.5);
  layout.look_at_m = {3.9, narrow ? 2.3 : 2.2, narrow ? 0.92 : 0.95};
  Stage& stage = layout.stage;
  stage.object = narrow ? Eigen::Vector2f(3.35F, 2.2F) : Eigen::Vector2f(3.2F, 2.15F);
  stage.path_half_m = {0.75F, narrow ? 0.85F : 1.1F};
  stage.spot = narrow ? Eigen::Vector2f(2.72F, 1.78F) : Eigen::Vector2f(2.5F, 1.74F);
  if (scenario == Scenario::kFar) {
    layout.eye_m = {0.22, 0.3, 1.55};
    layout.look_at_m = {3.9, 2.6, 0.85};
    stage.object = {3.55F, 2.45F};
    stage.path_half_m = {0.62F, 0.62F};
  }
  if (scenario == Scenario::kRounds) stage.way_in_m = stage.object.y() - 0.3F;
  if (scenario == Scenario::kSweep || scenario == Scenario::kStarts) {
    layout.eye_m = {1.2, 2.1, 1.45};
    layout.look_at_m = {3.9, 2.1, 1.45};
  }
  layout.eye_m = options.eye_m.value_or(layout.eye_m);
  layout.look_at_m = options.look_at_m.value_or(layout.look_at_m);
  if (scenario == Scenario::kEdges) layout.room.thin_things = true;
  layout.room.seat = scenario == Scenario::kStill || scenario == Scenario::kTalk;
  if (scenario == Scenario::kTalk && options.seed % 2 == 1) layout.room.seat = false;
  layout.room.guest_seat = options.people >= 2;
  layout.room.mirror = options.realism.mirror;
  layout.room.window = options.window;
  layout.room.desk_chair = !options.clear_floor;
  layout.room.moved_chair = options.day.moved_chair;
  layout.room.seat_foot = Vec3(stage.spot.x(), stage.spot.y(), 0);
  layout.room.seat_yaw_rad = kPi_f - 0.35F;
  const double yaw = 0.6 + 0.5 * uniform(hash_key(options.seed, 0x0B1));
  layout.world_from_object = {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
                              {stage.object.x(), stage.object.y(), 0}};
  if (options.object_m) layout.world_from_object.translation_m.head<2>() = *options.object_m;
  layout.pan_tilt =
      rig_of_seed(options.rig, options.seed, options.size_px, options.tolerance).pan_tilt;
  layout.light =
      make_light(scenario == Scenario::kDark, static_cast<float>(options.day.lamp_level));
  layout.camera_moves = scenario == Scenario::kPan || scenario == Scenario::kSweep ||
                        scenario == Scenario::kHandheld || scenario == Scenario::kPendulum ||
                        scenario == Scenario::kCarried || scenario == Scenario::kStarts ||
                        scenario == Scenario::kShot;
  if (options.sweep.crossing) {  // around the head
    stage.object = layout.eye_m.head<2>().cast<float>();
    stage.path_half_m = {0.8F, 1.1F};
  }
  return layout;
}

geometry::Pose rest_pose(const Layout& layout) {
  return geometry::look_at(layout.eye_m, layout.look_at_m, Eigen::Vector3d::UnitZ());
}

Volume capture_volume(const Layout& layout) {
  constexpr float kReach_m = 0.42F;  // of a person who walks along the path
  constexpr float kDeskX_m = 4.30F, kShelvesY_m = 3.95F;
  const Stage& stage = layout.stage;
  const Vec2 reach(kReach_m, kReach_m);
  const Vec2 way_in(stage.object.x(), stage.object.y() - stage.way_in_m);
  const Vec2 low = (stage.object - stage.path_half_m).cwiseMin(stage.spot).cwiseMin(way_in) - reach;
  const Vec2 high = ((stage.object + stage.path_half_m).cwiseMax(stage.spot) + reach)
                        .cwiseMin(Vec2(kDeskX_m, kShelvesY_m));
  return {{low.x(), low.y(), 0}, {high.x(), high.y(), 2.1}};
}

CameraPlace camera_at(const Layout& layout, const StudioOptions& options, double time_s) {
  const geometry::Pose rest = rest_pose(layout);
  switch (options.scenario) {
    case Scenario::kPan:
      return swept(rest, layout.pan_tilt, options.pan_rad, time_s, options.seed);
    case Scenario::kShot:
      return panned(rest, layout.pan_tilt, options, time_s);
    case Scenario::kSweep:
      if (options.sweep.views.empty())
        return as_moved(rest, layout.pan_tilt, options.sweep, time_s, options.seed);
      return at_view(rest, layout.pan_tilt, options.sweep, time_s, options.seed);
    case Scenario::kHandheld:
      return {shaken(rest, static_cast<float>(time_s), options.seed)};
    case Scenario::kPendulum:
      return {swung(rest, time_s)};
    case Scenario::kCarried:
      return {carried(rest, time_s, options.seed)};
    case Scenario::kStarts:
      return {thrown(rest, time_s, options.seed)};
    default:
      return {rest};
  }
}

}  // namespace mixrig::studio
