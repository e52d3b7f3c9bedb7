// SPDX-License-Identifier: Apache-2.0
// The compositor of a run, which follows what changes meanwhile: the room, the scene, objects.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "host/output/sink/frame_times.h"
#include "host/render/contract/compositor.h"
#include "host/run/controls/run_extra.h"
#include "host/run/controls/run_options.h"
#include "host/run/loop/setup_exchange.h"
#include "host/run/report/run_report.h"
#include "host/run/session/session.h"
#include "host/run/watchers/light_keeper.h"
#include "host/run/watchers/look_keeper.h"
#include "host/run/watchers/room_keeper.h"

namespace mixrig::session {

/// For the compositing thread of one run.
class RunCompositor {
 public:
  /// `session` and `options` outlive it. `follower`: whose changes are composited; null: a live run
  /// makes its own. `orders`: null, or it outlives this.
  RunCompositor(const Session& session, const RunOptions& options,
                std::shared_ptr<SceneFollower> follower, output::RunOrders* orders);

  /// `mover` moves objects; null: none does. Errors: those of the back end, of the watch, of a room
  /// that cannot be saved.
  Result<void> open(ObjectMover* mover, WorkGate* gate);

  /// Before a frame: what was saved, learned and ordered counts from this one on.
  void follow_changes();
  /// Poses of the objects of a frame, of which the camera's pose is set.
  void move_objects(output::Composite& composite);
  /// Errors: as Compositor::compose().
  Result<void> compose(const output::Composite& composite, render::OutputMask wanted,
                       render::FrameOutput& images);
  /// Of the frame composited last: counts how its plate came in.
  void count_plate(const capture::Capture& capture);
  const render::StageTimes& stage_times() const { return compositor_->state().stage_times; }
  /// Frames no longer show the scene that the truth is of.
  bool is_edited() const { return exchange_.is_edited(); }
  /// For the watch of the room. Errors: those of an earlier frame of it.
  Result<void> see(const output::CompositePtr& composite);
  /// Ends the watch, saves the room where that was asked for, frees the compositor. Once.
  Result<CompositorReport> finish();

 private:
  bool live() const { return session_.is_live(); }
  void place_moved_objects();
  void tell_possible() const;
  CompositorReport report() const;
  Result<void> save_room() const;
  void share_plates();
  void use(EditedScenePtr edited);
  std::optional<glm::ivec2> focus_pixel() const;
  std::optional<render::FrameLight> frame_light();

  const Session& session_;
  const RunOptions& options_;
  std::shared_ptr<SceneFollower> follower_;
  output::RunOrders* const orders_;
  std::optional<scene::FocusSettings> wanted_focus_;  ///< of the newest scene
  std::optional<glm::ivec2> focus_px_;                ///< that an operator chose
  ObjectMover* mover_ = nullptr;
  RoomKeeper keeper_;
  LightKeeper light_keeper_;
  LookKeeper look_keeper_;
  SetupExchange exchange_;  ///< has what compositor_ was made of
  FrameScene frame_scene_;
  bool scene_differs_ = false;                ///< of the frame: frame_scene_ from the setup
  std::vector<geometry::Pose> wanted_poses_;  ///< of objects with physics, that they were put at
  std::optional<geometry::Pose> last_pose_;   ///< of the camera
  FrameTimes times_;                          ///< for the physics
  std::unique_ptr<render::Compositor> compositor_;
  std::string backend_, renderer_;                         ///< of the first compositor
  std::optional<PlateReport> plates_;                      ///< of live devices
  render::PlateNeed asked_ = render::PlateNeed::kDecoded;  ///< of the source
  Image<float> no_depth_m_;  ///< of captures without: unknown everywhere
};

}  // namespace mixrig::session
