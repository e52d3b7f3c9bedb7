// SPDX-License-Identifier: Apache-2.0
// mixrig plan: where people went on the floor.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "host/session/plan.h"
#include "host/tools/command.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

struct PlanArguments {
  SessionArguments session;
  std::string out, frames;
};

void print(const session::PeopleReport& people) {
  std::printf("%zu people in %llu frames, at most %zu at once\n", people.people.size(),
              static_cast<unsigned long long>(people.frames), people.most_at_once);
  for (const session::PersonPath& p : people.people)
    std::printf("person %d: %.1f to %.1f s, %.2f m high, walked %.1f m\n", p.id, p.first_s,
                p.last_s, p.height_m, p.length_m);
  if (!people.error) return;
  const measure::PeopleErrors& e = *people.error;
  std::printf(
      "place on the floor: %.0f mm RMS, 95 %% within %.0f mm; NEES %.1f (2); missed %.1f %%, "
      "false %.1f %%; %d swaps and %d new tracks in %d crossings\n",
      e.rms_mm, e.p95_mm, e.nees, e.missed_pct, e.false_pct, e.swaps, e.broken, e.crossings);
}

Result<nlohmann::json> make(const PlanArguments& arguments) {
  MIXRIG_ASSIGN(session::SessionOptions session_arguments, session_options(arguments.session));
  session::PlanOptions options;
  options.out = arguments.out;
  if (!arguments.frames.empty()) {
    MIXRIG_ASSIGN(options.frames, parse_range(arguments.frames, "--frames"));
  }
  const StopOnSignal signals;
  SystemClock clock;
  session_arguments.clock = &clock;
  session_arguments.stop = options.stop = &StopOnSignal::flag();
  MIXRIG_ASSIGN(const auto session, session::open_session(session_arguments));
  MIXRIG_ASSIGN(const session::Plan plan,
                session::make_plan(*session, options, clock, progress_bar()));
  print(plan.people);
  return session::to_json(plan);
}

}  // namespace

void add_plan_command(Command app, Context& context) {
  auto arguments = std::make_shared<PlanArguments>();
  Command command = app.add_subcommand("plan", "where people went on the floor");
  add_session_options(command, arguments->session);
  command.add_option("--frames", arguments->frames,
                     "FIRST-LAST; all after the learned ones if not given");
  command.add_option("OUT", arguments->out, "folder to write, new or made by an earlier plan")
      .required();
  command.callback(
      [&context, arguments] { context.action = [arguments] { return make(*arguments); }; });
}

}  // namespace mixrig::tools
