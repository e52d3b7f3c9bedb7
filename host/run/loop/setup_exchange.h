// SPDX-License-Identifier: Apache-2.0
// Exchanges the compositor of a run where the background or the scene has changed.
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>

#include "hal/base/clock.h"
#include "hal/base/quantile_sketch.h"
#include "host/render/contract/compositor.h"
#include "host/run/controls/scene_follower.h"
#include "host/run/session/kept_background.h"

namespace mixrig::session {

/// For the compositing thread of one run. The new compositor is made in another thread while frames
/// of a live run go on with the old one; a recording waits, so that the same changes give the same
/// pictures. Must outlive the compositors that it gives.
class SetupExchange {
 public:
  /// `session` outlives it.
  SetupExchange(const Session& session, bool live) : session_(session), live_(live) {}

  /// From then on; null: nothing changed.
  void use(std::shared_ptr<const KeptBackground> background);
  void use(EditedScenePtr scene);
  /// Before a frame. `last_pose` is that of the frame before: what a compositor finds out once is
  /// found while it is made. Where it cannot be made (more lamps than the back end draws, no
  /// memory) the old one stays, with a warning.
  void exchange(std::unique_ptr<render::Compositor>& compositor,
                const std::optional<geometry::Pose>& last_pose);
  /// Waits for a compositor in the making, which is dropped.
  void finish();

  /// That the compositor was made of.
  const scene::Scene& scene() const;
  bool is_edited() const { return in_use_ && in_use_->scene; }
  /// Edited scenes that no compositor could be made of.
  std::uint64_t refused_scenes() const { return refused_scenes_; }
  /// Time that a frame lost by an exchange.
  const measure::QuantileSketch& swap_ms() const { return swap_ms_; }

 private:
  /// What a compositor was made of has to outlive it.
  struct Made {
    std::shared_ptr<const KeptBackground> background;  ///< null: the session's
    EditedScenePtr scene;                              ///< null: the session's
    render::CompositorSetup setup;
    std::unique_ptr<render::Compositor> compositor;
  };
  using MadePtr = std::unique_ptr<Made>;
  static Result<MadePtr> make(MadePtr made, BackendChoice backend);
  MadePtr begin(const std::optional<geometry::Pose>& last_pose) const;
  void refuse(const Error& error);

  const Session& session_;
  const bool live_;
  bool is_due_ = false;
  std::shared_ptr<const KeptBackground> background_;
  EditedScenePtr scene_;
  std::shared_ptr<const KeptBackground> tried_background_;  ///< that making_ is of
  EditedScenePtr tried_scene_;
  std::uint64_t refused_scenes_ = 0;
  MadePtr in_use_;
  std::future<Result<MadePtr>> making_;
  SystemClock clock_;
  measure::QuantileSketch swap_ms_;
};

}  // namespace mixrig::session
