// SPDX-License-Identifier: Apache-2.0
// The compositor of a run; it follows changes of the room, the scene and the objects.
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
  /// `session` and `options` must outlive it. `follower`: follows changes of the scene; null: a
  /// live run makes its own. `orders`: may be null, else must outlive it.
  RunCompositor(const Session& session, const RunOptions& options,
                std::shared_ptr<SceneFollower> follower, output::RunOrders* orders);

  /// Makes the compositor. `mover` moves objects; may be null. Errors: those of the back end and of
  /// the watch, and those of a room that cannot be saved.
  Result<void> open(ObjectMover* mover, WorkGate* gate);

  /// Takes over what was saved, learned and ordered; call it before a frame.
  void follow_changes();
  /// Sets the poses of the objects in a frame whose camera pose is set.
  void move_objects(output::Composite& composite);
  /// Composites a frame. Errors: those of Compositor::compose().
  Result<void> compose(const output::Composite& composite, render::OutputMask wanted,
                       render::FrameOutput& images);
  /// Counts whether the plate of the last frame was imported or copied.
  void count_plate(const capture::Capture& capture);
  const render::StageTimes& stage_times() const { return compositor_->state().stage_times; }
  /// Whether frames no longer show the scene that the truth belongs to.
  bool is_edited() const { return exchange_.is_edited(); }
  /// Gives a frame to the watch of the room. Errors: those of an earlier frame.
  Result<void> see(const output::CompositePtr& composite);
  /// Ends the watch, saves the room if requested, and frees the compositor. Call it once.
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
  std::optional<glm::ivec2> focus_px_;                ///< chosen by an operator
  ObjectMover* mover_ = nullptr;
  RoomKeeper keeper_;
  LightKeeper light_keeper_;
  LookKeeper look_keeper_;
  SetupExchange exchange_;  ///< owns what compositor_ was made of
  FrameScene frame_scene_;
  bool scene_differs_ = false;  ///< of the frame: frame_scene_ differs from the setup
  /// Last poses set from outside, of objects with physics.
  std::vector<geometry::Pose> wanted_poses_;
  std::optional<geometry::Pose> last_pose_;  ///< of the camera
  FrameTimes times_;                         ///< for physics
  std::unique_ptr<render::Compositor> compositor_;
  std::string backend_, renderer_;                         ///< of the first compositor
  std::optional<PlateReport> plates_;                      ///< for live devices
  render::PlateNeed asked_ = render::PlateNeed::kDecoded;  ///< last requested of the source
  Image<float> no_depth_m_;  ///< for captures without depth: unknown everywhere
};

}  // namespace mixrig::session
