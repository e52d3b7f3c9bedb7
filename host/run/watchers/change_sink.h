// SPDX-License-Identifier: Apache-2.0
// Watches the composited frames for what changed in the room, and learns what is accepted.
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

/// Looks at each frame that it is given, of five about one, in a picture of 160 pixels across.
/// write() and finish() on the thread of the sink; the rest as said. Memory is constant but for the
/// frames that a change is learned from.
class ChangeSink final : public output::CompositeSink {
 public:
  static constexpr int kFrameStep = 5;
  static constexpr int kWidth_px = 160;
  static constexpr int kLearnFrames = 9;  ///< of those looked at, which see half of the change

  /// Whether the session has a background that can be watched: drawn from its place at each pose,
  /// or of a camera that stands still, and a lens that stands still.
  static bool can_watch(const Session& session);
  /// Whether all of it can be learned anew: one view, of a camera that stands still.
  static bool can_scan(const Session& session);
  /// `session` is ready to composite. It obeys output::LearnChanges and output::LearnRoom of
  /// `orders`; null: nobody gives any. Both outlive it. Precondition: can_watch().
  static Result<std::unique_ptr<ChangeSink>> create(const Session& session,
                                                    const ChangeOptions& options,
                                                    output::RunOrders* orders);

  std::string_view name() const override { return "room changes"; }
  render::OutputMask wanted(int /*number*/) const override { return render::kMatte; }
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override { return {}; }

  /// The background with changes that were learned since the last call; null: none. Any thread.
  std::shared_ptr<KeptBackground> take_learned();
  /// After finish().
  RoomChangesReport report() const;
  /// The last background that changes were accepted into; null: none. After finish().
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
  Image<Rgbf> drawn_color_;  ///< its colours; empty without
  std::optional<geometry::Pose> drawn_at_;
  std::optional<geometry::Pose> first_pose_;
  std::optional<model::RoomWatch> watch_;
  std::vector<SeenFrame> kept_frames_;
  bool collecting_ = false;
  /// Of a scan: frames in the whole view.
  std::optional<FrameViews> scan_views_;
  std::optional<model::StaticBackgroundBuilder> scan_;
  int scan_left_ = 0;  ///< looks until it is complete
  std::shared_ptr<KeptBackground> kept_;
  RoomChangesReport report_;
  std::mutex mutex_;
  std::shared_ptr<KeptBackground> learned_;  ///< guarded by mutex_
};

}  // namespace mixrig::session
