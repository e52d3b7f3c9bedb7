// SPDX-License-Identifier: Apache-2.0
// Shares the objects that move by physics between the compositing thread and the thread that tracks
// people.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "extras/people/touch/physics.h"
#include "hal/base/clock.h"
#include "hal/base/quantile_sketch.h"
#include "host/run/controls/run_extra.h"

namespace mixrig::session {

class ObjectMotion final : public ObjectMover {
 public:
  /// Null where no object of the scene has physics. `session` outlives it.
  static std::unique_ptr<ObjectMotion> create(const Session& session);

  /// Advances the physics; the first call reads the room.
  std::span<const geometry::Pose> advance(double time_s,
                                          const geometry::Pose& world_from_camera) override;
  void place(std::size_t object, const geometry::Pose& world_from_object) override;
  /// Time of advance() for each frame. For the compositing thread, or after the run.
  const measure::QuantileSketch& advance_ms() const { return advance_ms_; }
  bool moves(std::size_t object) const { return moves_[object]; }
  /// For the thread that tracks people: moves out the hits up to that time that were not taken yet.
  void take_hits(double time_s, std::vector<touch::Event>& out);
  /// For the thread that tracks people: sets the surface of people near the objects in a frame.
  void push(std::span<const Eigen::Vector3f> surface_m, const Eigen::Vector3d& eye_m,
            double time_s);

 private:
  static constexpr std::size_t kMostHits = 1024;  ///< hits waiting to be taken; later ones are lost
  explicit ObjectMotion(const Session& session);

  void keep_hits();

  void step(double time_s, const geometry::Pose& world_from_camera);

  const Session& session_;
  SystemClock clock_;
  measure::QuantileSketch advance_ms_;
  touch::Physics physics_;
  std::vector<int> number_;  ///< number in physics_ of each scene object; -1: no shape
  std::vector<int> object_;  ///< number in the scene of each object in physics_
  std::vector<bool> moves_;
  std::vector<geometry::Pose> poses_;
  bool has_room_ = false;
  touch::PusherFinder finder_;
  std::vector<touch::Pusher> now_;  ///< used by the compositing thread
  std::mutex mutex_;
  std::vector<touch::Pusher> next_;  ///< guarded by mutex_
  bool has_next_ = false;            ///< guarded by mutex_
  std::vector<touch::Event> hits_;   ///< guarded by mutex_
};

}  // namespace mixrig::session
