// SPDX-License-Identifier: Apache-2.0
// What an extra (MIXRIG_EXTRAS) adds to a run: sinks, the motion of objects, parts of the report.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/math/geometry/pose.h"
#include "host/output/sink/composite_sink.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// A line of `mixrig explain`.
struct PassLine {
  std::string name, size, why;
  double p50_ms = 0;  ///< 0 for a pass that does not run
};

/// Moves objects of the scene. For the compositing thread of one run.
class ObjectMover {
 public:
  virtual ~ObjectMover() = default;
  /// world_from_object of each object of the scene at a time, seen from `world_from_camera`; valid
  /// until the next call. Never waits for more than a copy.
  virtual std::span<const geometry::Pose> advance(double time_s,
                                                  const geometry::Pose& world_from_camera) = 0;
  /// Before advance(): puts an object elsewhere; one that moves goes on from there, at rest.
  virtual void place(std::size_t object, const geometry::Pose& world_from_object) = 0;
};

/// What an extra is opened with. All but the folder's name outlive it.
struct ExtraSetup {
  const Session& session;
  const Clock& clock;
  const std::optional<std::filesystem::path>& folder;  ///< of the run's files; absent: none
  std::optional<std::int64_t> epoch_ns;                ///< as RunOptions::epoch_ns
};

/// One object a run. What it tells is complete after its sinks have finished.
class RunExtra {
 public:
  virtual ~RunExtra() = default;
  /// Its sinks, before the first frame; none where the scene does not need it.
  virtual Result<std::vector<std::unique_ptr<output::CompositeSink>>> open(
      const ExtraSetup& setup) = 0;
  /// After open(); null: it moves no object. A run of a recording waits for the sinks of an extra
  /// that does before each frame, so that the same take gives the same pictures.
  virtual ObjectMover* mover() { return nullptr; }
  /// Adds its keys to report.json (CONVENTIONS.md).
  virtual void add_to(nlohmann::json& report) const = 0;
  /// Its lines of the table that `mixrig run` prints.
  virtual std::string lines() const { return {}; }
  /// Its lines of `mixrig explain`, also where it did not run.
  virtual std::vector<PassLine> passes() const { return {}; }
};
using RunExtras = std::vector<std::shared_ptr<RunExtra>>;

}  // namespace mixrig::session
