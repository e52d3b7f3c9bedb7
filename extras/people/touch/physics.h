// SPDX-License-Identifier: Apache-2.0
// Simulates objects that fall, roll and are pushed by people.
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

/// Physical properties of a moving object.
struct Body {
  double mass_kg = 1;
  /// Share of the speed that remains after an impact on the room or on a fixed object, 0 to 1;
  /// between two moving objects the product of both shares counts.
  double bounce = 0.6;
  double friction = 0.5;  ///< of it, and of what it touches
  double drag = 0.1;      ///< share of the speed that is lost in a second
  bool is_ball = false;   ///< a ball around the middle of its box, instead of its parts
};

/// Simulates rigid bodies over a floor at height 0 (Bullet), in steps of kStep_s. Equal calls give
/// bitwise equal results. Not thread-safe.
class Physics {
 public:
  static constexpr double kStep_s = 1.0 / 480;
  static constexpr double kLongestGap_s = 0.25;  ///< longer gaps in time are skipped
  static constexpr std::size_t kMostPushers = 256;
  static constexpr double kFastest_m_s = 12;  ///< largest speed of an object

  Physics();
  ~Physics();
  Physics(const Physics&) = delete;
  Physics& operator=(const Physics&) = delete;

  /// Adds an object, which moves if `body` is given and is fixed if it is null. `shape` may be
  /// dropped afterwards. Returns the number of the object. Precondition: the shape has a part.
  int add(const Shape& shape, const geometry::Pose& world_from_object, const Body* body);
  /// Sets the room: its upright sides as boxes, and boxes over cells of the map elsewhere.
  void set_room(const plan::FloorMap& room, std::span<const RoomSide> sides = {});
  /// Sets the pushers; only the first kMostPushers count. They move on and act for half of
  /// kLongestGap_s from the current time.
  void set_pushers(std::span<const Pusher> pushers);
  /// Sets the velocity of an object with a body, in world axes.
  void set_velocity(int object, const Eigen::Vector3d& velocity_m_s);
  /// Puts an object elsewhere, at rest.
  void place(int object, const geometry::Pose& world_from_object);
  /// Advances the simulation to that time; the first call only sets the time.
  void advance(double time_s);
  /// Impacts of objects on the room and on each other during the last advance(), at the time when
  /// the gap closed, with the speed along the normal before the impact. Reports only impacts of 0.5
  /// m/s and more, and of repeated ones in one direction within 50 ms only the first.
  std::span<const Event> hits() const;
  /// Poses of the objects, in the order of add().
  std::span<const geometry::Pose> world_from_object() const;
  bool is_moving(int object) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::touch
