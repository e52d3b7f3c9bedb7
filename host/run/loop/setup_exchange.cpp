// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/setup_exchange.h"

#include <chrono>
#include <utility>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "host/run/session/session.h"

namespace mixrig::session {

void SetupExchange::use(std::shared_ptr<const KeptBackground> background) {
  if (!background) return;
  background_ = std::move(background), is_due_ = true;
}

void SetupExchange::use(EditedScenePtr scene) {
  if (!scene) return;
  scene_ = std::move(scene), is_due_ = true;
}

SetupExchange::MadePtr SetupExchange::begin(const std::optional<geometry::Pose>& last_pose) const {
  auto made = std::make_unique<Made>();
  made->background = background_, made->scene = scene_;
  made->setup = background_ ? background_->setup : session_.setup;
  if (scene_) set_scene(scene_->scene, scene_->meshes, made->setup);
  // The centre of projection of a lens that moves is not that of the pose.
  if (!made->setup.lens_moves) made->setup.first_pose = last_pose;
  return made;
}

Result<SetupExchange::MadePtr> SetupExchange::make(MadePtr made, BackendChoice backend) {
  MIXRIG_TRY(guarded("making the compositor", [&]() -> Result<void> {
    MIXRIG_ASSIGN(made->compositor, make_compositor(made->setup, backend));
    return {};
  }));
  return made;
}

void SetupExchange::exchange(std::unique_ptr<render::Compositor>& compositor,
                             const std::optional<geometry::Pose>& last_pose) {
  if (!making_.valid()) {
    if (!std::exchange(is_due_, false)) return;
    tried_background_ = background_, tried_scene_ = scene_;
    making_ = std::async(std::launch::async, make, begin(last_pose), session_.backend);
  }
  if (live_ && making_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  const HostTime start = clock_.now();
  auto made = making_.get();
  if (!made) return refuse(made.error());
  compositor = std::move((*made)->compositor);
  in_use_ = *std::move(made);
  swap_ms_.add(milliseconds(clock_.now() - start));
}

/// Refuses a setup; requests that came meanwhile stay due.
void SetupExchange::refuse(const Error& error) {
  log_warning("session", to_line(error) + ": the run keeps its previous setup");
  const auto shown_background = in_use_ ? in_use_->background : nullptr;
  const EditedScenePtr shown_scene = in_use_ ? in_use_->scene : nullptr;
  if (tried_scene_ != shown_scene) ++refused_scenes_;
  if (scene_ == tried_scene_) scene_ = shown_scene;
  if (background_ == tried_background_) background_ = shown_background;
}

void SetupExchange::finish() {
  if (making_.valid()) making_.wait();
}

const scene::Scene& SetupExchange::scene() const {
  return is_edited() ? in_use_->scene->scene : session_.scene;
}

}  // namespace mixrig::session
