// SPDX-License-Identifier: Apache-2.0
// Sink that watches frames for changes of the room, and learns those that are accepted.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_orders.h"
#include "host/room/background/frame_views.h"
#include "host/room/changes/room_watch.h"
#include "host/run/session/kept_background.h"
#include "host/run/watchers/room_changes_report.h"
#include "host/run/watchers/room_update.h"

namespace mixrig::session {

/// Looks at each frame that it is given (about one of five, by RoomKeeper), in a picture 160 pixels
/// wide. write() and finish() run in the sink's thread; other threads as stated. Memory is constant
/// except for the frames from which a change is learned.
class ChangeSink final : public output::CompositeSink {
 public:
  static constexpr int kFrameStep = 5;
  static constexpr int kWidth_px = 160;
  /// Number of examined frames that must each see half of the change.
  static constexpr int kLearnFrames = 9;

  /// Whether the session's background can be watched: it is drawn from its place at each pose, or
  /// belongs to a still camera, and the lens does not move.
  static bool can_watch(const Session& session);
  /// Whether the whole background can be learned again: a single view of a still camera.
  static bool can_scan(const Session& session);
  /// `session` must be ready to composite. Handles output::LearnChanges and output::LearnRoom of
  /// `orders`, which may be null. Both must outlive the sink. Precondition: can_watch().
  static Result<std::unique_ptr<ChangeSink>> create(const Session& session,
                                                    const ChangeOptions& options,
                                                    output::RunOrders* orders);

  std::string_view name() const override { return "room changes"; }
  render::OutputMask wanted(int /*number*/) const override { return render::kMatte; }
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override { return {}; }

  /// The background with changes learned since the last call; null: none. Any thread.
  std::shared_ptr<KeptBackground> take_learned();
  /// Precondition: finish() was called.
  RoomChangesReport report() const;
  /// The last background with accepted changes; null: none. Precondition: finish() was called.
  const KeptBackground* kept() const { return kept_.get(); }

 private:
  ChangeSink(const Session& session, const ChangeOptions& options, output::RunOrders* orders);
  Result<void> open();
  void draw_background();
  Result<void> look(const output::Composite& composite);
  void tell();
  Result<void> collect(const output::Composite& composite);
  Result<void> learn();
  Result<void> scan(const output::Composite& composite);
  Result<void> obey_scan_orders();
  void use_scan();
  void hand_out(std::shared_ptr<KeptBackground> next);

  const Session& session_;
  const ChangeOptions options_;
  output::RunOrders* const orders_;
  SystemClock clock_;
  Crew crew_{1};
  render::CompositorSetup small_;  ///< in the size of the watch
  std::optional<FrameViews> views_;
  std::unique_ptr<render::cpu::MovingBackground> drawn_;
  Image<Rgbf> drawn_color_;  ///< colours of drawn_; may be empty
  std::optional<geometry::Pose> drawn_at_;
  std::optional<geometry::Pose> first_pose_;
  std::optional<model::RoomWatch> watch_;
  std::vector<SeenFrame> kept_frames_;
  bool collecting_ = false;
  /// Draws frames in the full view, for a new scan of the room.
  std::optional<FrameViews> scan_views_;
  std::optional<model::StaticBackgroundBuilder> scan_;
  int scan_left_ = 0;  ///< captures until the scan is complete
  std::shared_ptr<KeptBackground> kept_;
  RoomChangesReport report_;
  std::mutex mutex_;
  std::shared_ptr<KeptBackground> learned_;  ///< guarded by mutex_
};

}  // namespace mixrig::session
