// SPDX-License-Identifier: Apache-2.0
// Reports what people and objects of a run touch: to a file, to receivers, and in the run's report.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "extras/people/touch/touch_watch.h"
#include "extras/people/watch/event_out.h"
#include "hal/base/clock.h"
#include "hal/base/quantile_sketch.h"
#include "host/output/sink/composite_sink.h"
#include "host/run/session/session.h"

namespace mixrig::session {

class ObjectMotion;

struct TouchReport {
  std::array<std::uint64_t, 4> counts{};  ///< by touch::EventKind
  SentCounts json, osc;                   ///< datagrams
  measure::QuantileSketch touch_ms;       ///< of a frame
};
nlohmann::json to_json(const TouchReport& report);

/// Shapes of the scene's objects, without those of a set, in object axes.
std::vector<touch::Shape> shapes_of(const scene::Scene& scene);

/// Detects touching; a step of the thread that tracks people.
class TouchStage {
 public:
  static constexpr const char* kFile = "events.jsonl";

  /// Makes a stage that writes kFile into `folder`, which must exist, one event a line; without a
  /// folder it writes no file. `session` must be ready to composite before the first frame; it,
  /// `report` and `motion`, which may be null, outlive the stage. Errors: kIo; those of
  /// EventOut::open().
  static Result<std::unique_ptr<TouchStage>> create(
      const Session& session, const std::optional<std::filesystem::path>& folder,
      ObjectMotion* motion, TouchReport& report);

  /// Processes a frame with a pose. Errors: kIo.
  Result<void> see(const output::Composite& composite, std::span<const plan::Person> people,
                   double time_s);
  /// Ends all contacts, with events. Errors: kIo.
  Result<void> finish();

 private:
  TouchStage(const Session& session, ObjectMotion* motion, TouchReport& report);
  Result<void> tell(std::span<const touch::Event> events);
  void push(std::span<const plan::Person> people, const Eigen::Vector3d& eye_m, double time_s);

  const Session& session_;
  ObjectMotion* const motion_;
  TouchReport& report_;
  touch::TouchWatch watch_;
  std::optional<EventOut> out_;  ///< after create()
  std::filesystem::path file_;
  std::ofstream lines_;
  std::vector<geometry::Pose> poses_;  ///< of the objects in this frame
  std::vector<Eigen::Vector3f> near_m_;
  std::vector<touch::Event> hits_;  ///< hits of moving objects in this frame
  int frame_ = 0;
  double time_s_ = 0;
  bool has_room_ = false;
  SystemClock clock_;
};

}  // namespace mixrig::session
