// SPDX-License-Identifier: Apache-2.0
// Options of a run, and the parts that join it.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/clock_sync.h"
#include "hal/base/frame_range.h"
#include "host/output/files/files_sink.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_orders.h"
#include "host/run/controls/run_extra.h"
#include "host/run/controls/scene_follower.h"
#include "host/run/watchers/room_changes_report.h"
#include "host/scene/scene.h"

namespace mixrig::session {

struct RunOptions {
  std::optional<std::filesystem::path> out;  ///< absent: no files
  output::OutputOptions output;
  std::optional<FrameRange> frames;  ///< absent: Session::default_frames()
  int sheet_rows = 6;                ///< frames on the contact sheet
  bool judge = true;                 ///< compare with truth, if the source has any
  bool true_people = false;          ///< sinks get people's true places, if the source has them
  /// The system time. If set, poses are sent to the programs that the scene names.
  EpochReader epoch;
  std::vector<scene::StreamOut> streams;  ///< in addition to those of the scene
  bool baselines = false;                 ///< also judge plain composites
  /// Whether to watch the room for changes, if the background can be watched; absent: in live runs.
  std::optional<bool> watch_room;
  ChangeOptions changes;  ///< which changes become background
  /// Folder for the background with accepted changes.
  std::optional<std::filesystem::path> save_room;
  /// View pixel whose depth is in focus from the first frame on; absent: as in the scene.
  std::optional<glm::ivec2> focus_px;
};

/// Objects that join one run, which takes them over.
struct RunParts {
  /// In addition to those for RunOptions::out.
  std::vector<std::unique_ptr<output::CompositeSink>> sinks{};
  RunExtras extras{};  ///< extras that the scene needs
  /// Follows changes of the scene; null: a live run makes its own.
  std::shared_ptr<SceneFollower> scene{};
  output::RunOrders* orders = nullptr;      ///< of an operator; null: no orders
  const std::atomic<bool>* stop = nullptr;  ///< when set, the run ends with the frames done so far
};

}  // namespace mixrig::session
