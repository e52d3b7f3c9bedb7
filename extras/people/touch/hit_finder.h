// SPDX-License-Identifier: Apache-2.0
// Finds impacts of bodies in a Bullet world, as events.
#pragma once

#include <span>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "extras/people/touch/contact.h"

namespace mixrig::touch {

/// Identifies bodies by their user index: a RoomPart, or kFirstObject plus the object's index in
/// the order of add(). Other bodies are ignored.
class HitFinder {
 public:
  static constexpr int kFirstObject = 100;
  static constexpr double kLeastSpeed_m_s = 0.5;
  static constexpr double kOneHit_s = 0.05;  ///< impacts of a pair in one direction are one hit

  void add(const btRigidBody& object) { objects_.push_back({&object}); }
  void before_step();
  /// `begin_s`: time at the beginning of the step.
  void after_step(btDispatcher& dispatcher, double begin_s);
  /// Impacts found since forget().
  std::span<const Event> found() const { return found_; }
  void forget() { found_.clear(); }

 private:
  struct Object {
    const btRigidBody* body = nullptr;
    btVector3 velocity_m_s{0, 0, 0}, turn_rad_s{0, 0, 0};  ///< before the step
  };
  struct Struck {
    int object = 0, other = 0;
    btVector3 normal;
    double time_s = 0;
  };
  btVector3 velocity_before(int number, const btVector3& at) const;
  void strike(const btPersistentManifold& manifold, double begin_s);
  bool is_known(const Struck& now);

  std::vector<Object> objects_;
  std::vector<Event> found_;
  std::vector<Struck> struck_;  ///< impacts within the last kOneHit_s
};

}  // namespace mixrig::touch
