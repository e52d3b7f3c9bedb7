// SPDX-License-Identifier: Apache-2.0
// What whoever starts a run asks for, and what joins it.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

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
  std::optional<std::filesystem::path> out;  ///< no files where absent
  output::OutputOptions output;
  std::optional<FrameRange> frames;  ///< Session::default_frames where absent
  int sheet_rows = 6;                ///< frames on the contact sheet
  bool judge = true;                 ///< against truth, where the source has any
  bool true_people = false;          ///< sinks get their places, where the source has them
  /// Of 1970, at host time 0: poses are sent to the programs that the scene names.
  std::optional<std::int64_t> epoch_ns;
  std::vector<scene::StreamOut> streams;  ///< in addition to those of the scene
  bool baselines = false;                 ///< judge plain composites beside it
  /// For changes, where the background can be watched; absent: in live runs.
  std::optional<bool> watch_room;
  ChangeOptions changes;                           ///< which of them become background
  std::optional<std::filesystem::path> save_room;  ///< where the background with them is written
  /// Pixel of the view whose depth is sharp from the first frame on; absent: as the scene says.
  std::optional<glm::ivec2> focus_px;
};

/// What joins one run, and is used up by it.
struct RunParts {
  std::vector<std::unique_ptr<output::CompositeSink>> sinks{};  ///< in addition to those of `out`
  RunExtras extras{};  ///< that do what the scene asks of them
  /// Whose changes of the scene are composited; null: a live run makes its own.
  std::shared_ptr<SceneFollower> scene{};
  output::RunOrders* orders = nullptr;      ///< of an operator; null: nobody gives any
  const std::atomic<bool>* stop = nullptr;  ///< when set, the run ends with the frames done so far
};

}  // namespace mixrig::session
