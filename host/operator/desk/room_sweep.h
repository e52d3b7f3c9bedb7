// SPDX-License-Identifier: Apache-2.0
// Scans the room with the pan-tilt unit of a rig during a run.
#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <thread>

#include "hal/base/clock.h"
#include "host/operator/desk/scene_desk.h"
#include "host/operator/page/operator.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// Turns the head through the views of a sweep, takes them from the frames of the run, and returns
/// the head. Models the room in a low-priority thread and writes it as background into the scene's
/// file, where it takes effect at the next start. Rooms are written to rooms/ beside the scene.
/// Thread-safe.
class RoomSweep {
 public:
  /// All arguments must outlive it; `scene` must belong to the session.
  RoomSweep(const Session& session, SceneDesk& scene, Clock& clock)
      : session_(session), scene_(scene), clock_(clock) {}
  /// Ends a sweep; waits for a room that is being modelled.
  ~RoomSweep();
  RoomSweep(const RoomSweep&) = delete;
  RoomSweep& operator=(const RoomSweep&) = delete;

  /// Starts a sweep. Errors: kUnsupported where this run cannot sweep, with the reason; kData while
  /// a sweep runs; kUsage where the room exists already. Errors of the sweep itself are reported by
  /// state().
  Result<void> start(const page::StartSweep& wanted);
  /// Ends the sweep and removes its views. Errors: kData if no head is being turned.
  Result<void> cancel();
  page::SweepState state() const;

 private:
  std::string why_not() const;
  void work(const page::StartSweep& wanted, const std::filesystem::path& folder);
  Result<void> make_room(const page::StartSweep& wanted, const std::filesystem::path& folder);
  void hold_colors() const;
  void set_phase(page::SweepState::Phase phase);

  const Session& session_;
  SceneDesk& scene_;
  Clock& clock_;
  std::atomic<bool> stop_ = false, cancelled_ = false;
  mutable std::mutex mutex_;  ///< guards state_
  page::SweepState state_;
  std::mutex thread_mutex_;  ///< guards thread_
  std::thread thread_;
};

}  // namespace mixrig::session
