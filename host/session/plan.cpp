// SPDX-License-Identifier: Apache-2.0
#include "host/session/plan.h"

#include <utility>

#include <nlohmann/json.hpp>

#include "hal/base/partial_path.h"

namespace mixrig::session {
namespace {

constexpr const char* kPlanReport = "report.json";

}  // namespace

Result<Plan> make_plan(Session& session, const PlanOptions& options, const Clock& clock,
                       const ProgressFn& progress) {
  MIXRIG_ASSIGN(PartialPath folder, make_partial_folder(options.out, kPlanReport));
  Plan plan;
  MIXRIG_ASSIGN(auto sink, PeopleSink::create(folder.path(), options.people, plan.people));
  RunOptions run_options;
  run_options.frames = options.frames, run_options.stop = options.stop;
  run_options.judge = false, run_options.true_people = true;
  run_options.watch_room = false;
  run_options.sinks.push_back(std::move(sink));
  MIXRIG_TRY(run(session, std::move(run_options), clock, progress));
  MIXRIG_TRY(write_file(folder.path() / kPlanReport, to_json(plan).dump(2) + "\n"));
  MIXRIG_TRY(folder.commit());
  return plan;
}

nlohmann::json to_json(const Plan& plan) { return to_json(plan.people); }

}  // namespace mixrig::session
