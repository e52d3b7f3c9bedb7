// SPDX-License-Identifier: Apache-2.0
// What an extra (MIXRIG_EXTRAS) adds to a run: sinks, the motion of objects, parts of the report.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/clock.h"
#include "hal/base/clock_sync.h"
#include "hal/base/result.h"
#include "host/math/geometry/pose.h"
#include "host/output/sink/composite_sink.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// One line of `mixrig explain`.
struct PassLine {
  std::string name, size, why;
  double p50_ms = 0;  ///< 0 for a pass that does not run
};

/// Moves objects of the scene. For the compositing thread of one run.
class ObjectMover {
 public:
  virtual ~ObjectMover() = default;
  /// world_from_object of each object of the scene at a time, for a camera at `world_from_camera`;
  /// valid until the next call. Never waits longer than a copy takes.
  virtual std::span<const geometry::Pose> advance(double time_s,
                                                  const geometry::Pose& world_from_camera) = 0;
  /// Puts an object elsewhere, before advance(); a moving object continues from there, at rest.
  virtual void place(std::size_t object, const geometry::Pose& world_from_object) = 0;
};

/// What an extra is opened with. Everything but `folder` and `epoch` outlives the extra.
struct ExtraSetup {
  const Session& session;
  const Clock& clock;
  const std::optional<std::filesystem::path>& folder;  ///< of the run's files; absent: none
  EpochReader epoch;                                   ///< RunOptions::epoch
};

/// What an extra contributes to one run. Its report is complete after its sinks have finished.
class RunExtra {
 public:
  virtual ~RunExtra() = default;
  /// Returns its sinks, before the first frame; empty if the scene does not need it.
  virtual Result<std::vector<std::unique_ptr<output::CompositeSink>>> open(
      const ExtraSetup& setup) = 0;
  /// Call it after open(). Null: it moves no object. A run of a recording waits before each frame
  /// for the sinks of an extra that moves objects, so that the same take gives the same pictures.
  virtual ObjectMover* mover() { return nullptr; }
  /// Adds its keys to report.json (docs/reference/report.md).
  virtual void add_to(nlohmann::json& report) const = 0;
  /// Its lines of the table that `mixrig run` prints.
  virtual std::string lines() const { return {}; }
  /// Its lines of `mixrig explain`, also where it did not run.
  virtual std::vector<PassLine> passes() const { return {}; }
};
using RunExtras = std::vector<std::shared_ptr<RunExtra>>;

}  // namespace mixrig::session
