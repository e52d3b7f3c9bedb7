// SPDX-License-Identifier: Apache-2.0
// Traces and lights the rays of a frame: the room once, people in each frame.
#include <array>
#include <utility>

#include "studio/light/object_gloss.h"
#include "studio/studio_state.h"

namespace mixrig::studio {
namespace {

constexpr int kTraceBand = 4;

}  // namespace

void Studio::State::trace_static(const CameraPlace& place, double time_s, bool with_truth) {
  // A camera that moves may rest: at mid-exposure and when the depth cameras expose.
  const auto at = [&](double delay_s) {
    return camera_at(layout, options, time_s + delay_s).world_from_target;
  };
  const std::array poses{place.world_from_target, at(tof.sensor().delay_s),
                         at(tof2 ? tof2->camera.sensor().delay_s : 0)};
  const bool rests = std::exchange(traced_from, poses) == poses;
  const bool keep = options.cache && rests && !options.day.changes();
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
  crew.rows(options.size_px.height, kTraceBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < options.size_px.width; ++x) {
        const float z = view.room.centre_z(x, y);
        const Vec3 point =
            rays.position + z * rays.direction(static_cast<float>(x), static_cast<float>(y));
        at.sees_room.at(x, y) = z < kMiss && visible_to_tof(at, optics, point, room) ? 1 : 0;
      }
  });
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

}  // namespace mixrig::studio
