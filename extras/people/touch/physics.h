// SPDX-License-Identifier: Apache-2.0
// Objects that fall, roll and are pushed by people.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "extras/people/plan/floor_map.h"
#include "extras/people/touch/contact.h"
#include "extras/people/touch/pusher_finder.h"
#include "extras/people/touch/room_sides.h"
#include "extras/people/touch/shape.h"
#include "host/math/geometry/pose.h"

namespace mixrig::touch {

/// Of an object that moves.
struct Body {
  double mass_kg = 1;
  /// Share of the speed that is left after an impact on the room or on what stands still, 0 to 1;
  /// of two that move the product of both.
  double bounce = 0.6;
  double friction = 0.5;  ///< of it, and of what it touches
  double drag = 0.1;      ///< share of the speed that is lost in a second
  bool is_ball = false;   ///< a ball around the middle of its box, instead of its parts
};

/// Rigid bodies over a floor at height 0 (Bullet), in steps of kStep_s: the same calls give the
/// same bits. Not thread-safe.
class Physics {
 public:
  static constexpr double kStep_s = 1.0 / 480;
  static constexpr double kLongestGap_s = 0.25;  ///< of the time, longer ones are left out
  static constexpr std::size_t kMostPushers = 256;
  static constexpr double kFastest_m_s = 12;  ///< of an object

  Physics();
  ~Physics();
  Physics(const Physics&) = delete;
  Physics& operator=(const Physics&) = delete;

  /// An object that stands still, or with a body, that moves. `shape` may be dropped afterwards.
  /// The number of the object. Precondition: the shape has a part.
  int add(const Shape& shape, const geometry::Pose& world_from_object, const Body* body);
  /// What stands on the floor, and walls: the sides as they are, cells of the map elsewhere.
  void set_room(const plan::FloorMap& room, std::span<const RoomSide> sides = {});
  /// The first kMostPushers count; valid for half of kLongestGap_s of the time from now on, in
  /// which they move on.
  void set_pushers(std::span<const Pusher> pushers);
  /// Of an object with a body, world axes.
  void set_velocity(int object, const Eigen::Vector3d& velocity_m_s);
  /// Puts an object elsewhere, at rest.
  void place(int object, const geometry::Pose& world_from_object);
  /// Goes on to that time; the first call only sets it.
  void advance(double time_s);
  /// Of the last advance(): impacts of objects on the room and on each other, at the time when the
  /// gap closed, with the speed along the normal before; those of 0.5 m/s and more, and of what
  /// touches again in the same direction within 50 ms the first.
  std::span<const Event> hits() const;
  /// Of each object, in the order of add().
  std::span<const geometry::Pose> world_from_object() const;
  bool is_moving(int object) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::touch
