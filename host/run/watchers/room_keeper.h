// SPDX-License-Identifier: Apache-2.0
// Watches the background of a run for changes, in its own thread.
#pragma once

#include <filesystem>
#include <memory>

#include "host/run/session/kept_background.h"
#include "host/run/watchers/frame_watch.h"
#include "host/run/watchers/room_changes_report.h"

namespace mixrig::output {
class RunOrders;
}

namespace mixrig::session {

class ChangeSink;

/// For the compositing thread of one run.
class RoomKeeper {
 public:
  RoomKeeper(const Session& session, bool live) : session_(session), live_(live) {}

  /// Opens the watch; does nothing if ChangeSink::can_watch() is false. `orders`: may be null, else
  /// must outlive this object. Errors: those of ChangeSink::create().
  Result<void> open(const ChangeOptions& options, output::RunOrders* orders, WorkGate* gate);
  bool is_open() const { return watch_.sink() != nullptr; }
  /// Gives about one of five finished frames to the watch; if a live run loses that one, the next.
  /// Errors: those of an earlier frame.
  Result<void> push(const output::CompositePtr& composite);
  /// The background with changes accepted since the last call; null: none.
  std::shared_ptr<const KeptBackground> take_learned();
  /// Ends the watch. Errors: those of the watch.
  Result<void> finish();
  /// Precondition: finish() was called, and is_open().
  RoomChangesReport report() const;
  const KeptBackground* kept() const;

 private:
  const Session& session_;
  const bool live_;
  int next_look_ = 0;  ///< a frame number
  FrameWatch<ChangeSink> watch_;
};

/// Writes the background with accepted changes in the form that the scene named, a room or a
/// background of one view; whole or not at all. Errors: kUsage if the scene joins several rooms;
/// kIo, kFormat.
Result<void> save_kept(const Session& session, const KeptBackground& kept,
                       const std::filesystem::path& folder);
/// Checks before the run what save_kept() would refuse. Errors: kUsage.
Result<void> check_save(const Session& session, const std::filesystem::path& folder);

}  // namespace mixrig::session
