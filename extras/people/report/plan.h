// SPDX-License-Identifier: Apache-2.0
// Tracks people on the floor over a whole run: paths, pictures, report.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>

#include "extras/people/plan/people_tracker.h"
#include "extras/people/plan/placing.h"
#include "extras/people/watch/people_sink.h"
#include "extras/people/watch/touch_stage.h"
#include "host/run/loop/run.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// The file by which the folder of an earlier plan is known.
inline constexpr const char* kPlanReport = "report.json";

struct PlanOptions {
  std::filesystem::path out;
  std::optional<FrameRange> frames;
  const std::atomic<bool>* stop = nullptr;
  plan::PeopleOptions people;
  plan::Footprint box;  ///< size of the object to find places for
  int places = 0;       ///< number of places to find
  plan::PlacingOptions placing;
};

struct Plan {
  PeopleReport people;
  std::optional<TouchReport> events;  ///< absent unless the scene has objects
  double free_m2 = 0;                 ///< area of the free floor that was seen
  double open_m2 = 0;  ///< part of it farther than the margin from everything in the room
  std::vector<plan::FreePlace> places;
};

/// Runs the session's key and writes OUT, whole or not at all: people.csv, events.jsonl,
/// report.json, paths.glb (lines, if anybody walked), plan.png, dwell.png and picture.png. Errors:
/// those of run(); kData where no frame has a pose, or places are wanted and no floor was seen.
Result<Plan> make_plan(Session& session, const PlanOptions& options, const Clock& clock,
                       const ProgressFn& progress);
nlohmann::json to_json(const Plan& plan);

}  // namespace mixrig::session
