// SPDX-License-Identifier: Apache-2.0
// People on the floor over a whole run: paths, pictures, report.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>

#include "host/plan/people_tracker.h"
#include "host/session/people_sink.h"
#include "host/session/run.h"
#include "host/session/session.h"

namespace mixrig::session {

struct PlanOptions {
  std::filesystem::path out;
  std::optional<FrameRange> frames;
  const std::atomic<bool>* stop = nullptr;
  plan::PeopleOptions people;
};

struct Plan {
  PeopleReport people;
};

/// Runs the session's key and writes OUT, whole or not at all: people.csv and report.json.
/// Errors: those of run(); kUsage where the scene has nothing that keys people.
Result<Plan> make_plan(Session& session, const PlanOptions& options, const Clock& clock,
                       const ProgressFn& progress);
nlohmann::json to_json(const Plan& plan);

}  // namespace mixrig::session
