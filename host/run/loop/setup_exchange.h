// SPDX-License-Identifier: Apache-2.0
// Replaces the compositor of a run when the background or the scene has changed.
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

/// For the compositing thread of one run. A live run goes on with the old compositor while the new
/// one is made in another thread; a recording waits, so that the same changes give the same
/// pictures. Must outlive the compositors that it gives.
class SetupExchange {
 public:
  /// `session` must outlive it.
  SetupExchange(const Session& session, bool live) : session_(session), live_(live) {}

  /// Sets what the next compositor is made of; null: no change.
  void use(std::shared_ptr<const KeptBackground> background);
  void use(EditedScenePtr scene);
  /// Replaces `compositor` if a new one is ready; call it before a frame. `last_pose`: pose of the
  /// frame before, for tables that are built with the compositor. If the new one cannot be made
  /// (more lamps than the back end draws, no memory) the old one stays, with a warning.
  void exchange(std::unique_ptr<render::Compositor>& compositor,
                const std::optional<geometry::Pose>& last_pose);
  /// Waits for a compositor in the making and discards it.
  void finish();

  /// The scene of the compositor in use.
  const scene::Scene& scene() const;
  bool is_edited() const { return in_use_ && in_use_->scene; }
  /// Number of edited scenes from which no compositor could be made.
  std::uint64_t refused_scenes() const { return refused_scenes_; }
  /// Time that a frame lost by a replacement.
  const measure::QuantileSketch& swap_ms() const { return swap_ms_; }

 private:
  /// A compositor with what it was made of, which must outlive it.
  struct Made {
    std::shared_ptr<const KeptBackground> background;  ///< null: that of the session
    EditedScenePtr scene;                              ///< null: that of the session
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
  /// Background of the compositor in the making.
  std::shared_ptr<const KeptBackground> tried_background_;
  EditedScenePtr tried_scene_;
  std::uint64_t refused_scenes_ = 0;
  MadePtr in_use_;
  std::future<Result<MadePtr>> making_;
  SystemClock clock_;
  measure::QuantileSketch swap_ms_;
};

}  // namespace mixrig::session
