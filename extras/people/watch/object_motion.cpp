// SPDX-License-Identifier: Apache-2.0
#include "extras/people/watch/object_motion.h"

#include <algorithm>
#include <utility>

#include "extras/people/watch/plan_room.h"
#include "extras/people/watch/touch_stage.h"

namespace mixrig::session {

std::unique_ptr<ObjectMotion> ObjectMotion::create(const Session& session) {
  const auto& objects = session.scene.objects;
  const bool any =
      std::any_of(objects.begin(), objects.end(), [](const auto& o) { return o.physics; });
  return std::unique_ptr<ObjectMotion>(any ? new ObjectMotion(session) : nullptr);
}

ObjectMotion::ObjectMotion(const Session& session) : session_(session) {
  const std::vector<touch::Shape> shapes = shapes_of(session.scene);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const scene::Object& object = session.scene.objects[i];
    touch::Body body;
    if (object.physics)
      body = {object.physics->mass_kg, object.physics->bounce, object.physics->friction,
              object.physics->drag, object.physics->is_ball};
    const bool solid = !shapes[i].parts.empty();
    if (solid) object_.push_back(static_cast<int>(i));
    number_.push_back(
        solid ? physics_.add(shapes[i], object.world_from_object, object.physics ? &body : nullptr)
              : -1);
    moves_.push_back(solid && object.physics);
    if (moves_.back()) physics_.set_velocity(number_.back(), object.physics->velocity_m_s);
    poses_.push_back(object.world_from_object);
  }
}

std::span<const geometry::Pose> ObjectMotion::advance(double time_s,
                                                      const geometry::Pose& world_from_camera) {
  const HostTime begin = clock_.now();
  step(time_s, world_from_camera);
  advance_ms_.add(milliseconds(clock_.now() - begin));
  return poses_;
}

void ObjectMotion::step(double time_s, const geometry::Pose& world_from_camera) {
  if (!std::exchange(has_room_, true)) {
    const std::vector<plan::RoomPoint> points = room_points(session_, world_from_camera);
    const plan::FloorMap map = plan::map_floor(points);
    physics_.set_room(map, touch::find_sides(points, map));
  }
  bool has_now = false;
  {
    const std::lock_guard lock(mutex_);
    has_now = std::exchange(has_next_, false);
    if (has_now) std::swap(now_, next_);
  }
  if (has_now) physics_.set_pushers(now_);
  physics_.advance(time_s);
  for (std::size_t i = 0; i < poses_.size(); ++i)
    if (number_[i] >= 0)
      poses_[i] = physics_.world_from_object()[static_cast<std::size_t>(number_[i])];
  keep_hits();
}

void ObjectMotion::place(std::size_t object, const geometry::Pose& world_from_object) {
  poses_[object] = world_from_object;
  if (number_[object] >= 0) physics_.place(number_[object], world_from_object);
}

/// Stores the hits of the last step, with the numbers of the scene's objects.
void ObjectMotion::keep_hits() {
  const auto hits = physics_.hits();
  if (hits.empty()) return;
  const std::lock_guard lock(mutex_);
  for (touch::Event hit : hits) {
    hit.object = object_[static_cast<std::size_t>(hit.object)];
    if (hit.against == touch::Against::kObject)
      hit.other = object_[static_cast<std::size_t>(hit.other)];
    if (hits_.size() < kMostHits) hits_.push_back(hit);
  }
}

void ObjectMotion::take_hits(double time_s, std::vector<touch::Event>& out) {
  out.clear();
  const std::lock_guard lock(mutex_);
  const auto later = std::stable_partition(hits_.begin(), hits_.end(),
                                           [&](const auto& hit) { return hit.time_s <= time_s; });
  out.assign(hits_.begin(), later);
  hits_.erase(hits_.begin(), later);
}

void ObjectMotion::push(std::span<const Eigen::Vector3f> surface_m, const Eigen::Vector3d& eye_m,
                        double time_s) {
  const auto pushers = finder_.find(surface_m, eye_m, time_s);
  const std::lock_guard lock(mutex_);
  next_.assign(pushers.begin(), pushers.end());
  has_next_ = true;
}

}  // namespace mixrig::session
