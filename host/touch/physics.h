// SPDX-License-Identifier: Apache-2.0
// Objects that fall, roll and are pushed by people.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "host/geometry/pose.h"
#include "host/plan/floor_map.h"
#include "host/touch/shape.h"

namespace mixrig::touch {

/// Of an object that moves.
struct Body {
  double mass_kg = 1;
  double bounce = 0.6;    ///< share of the speed that is left after an impact, 0 to 1
  double friction = 0.5;  ///< of it, and of what it touches
  double drag = 0.1;      ///< share of the speed that is lost in a second
  bool is_ball = false;   ///< a ball around the middle of its box, instead of its parts
};

/// A part of a person's surface, as a ball that moves.
struct Pusher {
  static constexpr float kRadius_m = 0.05F;
  Eigen::Vector3f at_m = Eigen::Vector3f::Zero();  ///< its middle, world
  Eigen::Vector3f velocity_m_s = Eigen::Vector3f::Zero();
};

/// Rigid bodies over a floor at height 0 (Bullet), in steps of kStep_s: the same calls give the
/// same bits. Not thread-safe.
class Physics {
 public:
  static constexpr double kStep_s = 1.0 / 240;
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
  /// What stands on the floor, and walls.
  void set_room(const plan::FloorMap& room);
  /// The first kMostPushers count; valid for half of kLongestGap_s of the time from now on, in
  /// which they move on.
  void set_pushers(std::span<const Pusher> pushers);
  /// Goes on to that time; the first call only sets it.
  void advance(double time_s);
  /// Of each object, in the order of add().
  std::span<const geometry::Pose> world_from_object() const;
  bool is_moving(int object) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The surface of people near the objects, as balls in cells of a third of their width, whose
/// velocity is that of the nearest cell of the frame before, along the motion (normal flow). One
/// thread; no allocation once the buffers have grown.
class PusherFinder {
 public:
  static constexpr double kReach_m = 0.6;  ///< from an object
  /// Precondition: time grows.
  std::span<const Pusher> find(std::span<const Eigen::Vector3f> surface_m,
                               const Eigen::Vector3d& eye_m, double time_s);

 private:
  struct Cell {
    long key = 0;
    Eigen::Vector3f sum_m = Eigen::Vector3f::Zero();
    int count = 0;
  };
  std::vector<Cell> cells_;
  std::vector<Eigen::Vector3f> before_m_, now_m_;
  std::vector<Pusher> pushers_;
  double before_s_ = 0;
  bool has_before_ = false;
};

}  // namespace mixrig::touch
