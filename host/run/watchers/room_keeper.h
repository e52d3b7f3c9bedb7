// SPDX-License-Identifier: Apache-2.0
// Keeps the background of a run alive: a thread that watches it.
#pragma once

#include <filesystem>
#include <memory>

#include "host/run/session/kept_background.h"
#include "host/run/watchers/frame_watch.h"
#include "host/run/watchers/room_changes_report.h"

namespace mixrig::session {

class ChangeSink;

/// For the compositing thread of one run.
class RoomKeeper {
 public:
  RoomKeeper(const Session& session, bool live) : session_(session), live_(live) {}

  /// Does nothing where ChangeSink::can_watch() is false. `orders`: null, or it outlives this.
  /// Errors: those of ChangeSink::create().
  Result<void> open(const ChangeOptions& options, output::RunOrders* orders, WorkGate* gate);
  bool is_open() const { return watch_.sink() != nullptr; }
  /// Gives one of five finished frames to the watch, and where a live run loses some, the next one
  /// that there is. Errors: those of an earlier one.
  Result<void> push(const output::CompositePtr& composite);
  /// The background with changes that were accepted since the last call; null: none.
  std::shared_ptr<const KeptBackground> take_learned();
  /// Ends the watch. Errors: those of the watch.
  Result<void> finish();
  /// After finish(); precondition: is_open().
  RoomChangesReport report() const;
  const KeptBackground* kept() const;

 private:
  const Session& session_;
  const bool live_;
  int next_look_ = 0;  ///< number of a frame
  FrameWatch<ChangeSink> watch_;
};

/// Writes the background that changes were accepted into as a room, or a background of one view, of
/// the kind that the scene named; whole or not at all. Errors: kUsage where the scene joins several
/// rooms; kIo, kFormat.
Result<void> save_kept(const Session& session, const KeptBackground& kept,
                       const std::filesystem::path& folder);
/// What save_kept() would refuse, before the run. Errors: kUsage.
Result<void> check_save(const Session& session, const std::filesystem::path& folder);

}  // namespace mixrig::session
