// SPDX-License-Identifier: Apache-2.0
// mixrig plan: where people went on the floor.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "extras/people/report/plan.h"
#include "hal/base/angles.h"
#include "hal/base/output_folder.h"
#include "host/tools/command.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

struct PlanArguments {
  SessionArguments session;
  std::string out, frames, box = "0.5,0.5,1";
  int suggest = 0;
  double margin_m = plan::PlacingOptions{}.path_margin_m;
};

/// "WIDTH,DEPTH,HEIGHT". Errors: kUsage.
Result<plan::Footprint> parse_box(const std::string& text) {
  plan::Footprint box;
  char rest = 0;
  constexpr double kMost_m = 10;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &box.size_m.x(), &box.size_m.y(), &box.height_m,
                  &rest) != 3 ||
      !(box.size_m.minCoeff() > 0 && box.height_m > 0) ||
      !(box.size_m.maxCoeff() <= kMost_m && box.height_m <= kMost_m))
    return Error{ErrorCode::kUsage, "--box " + text +
                                        ": expected width, depth and height in metres, each above "
                                        "0 and at most 10, such as 0.5,0.5,1"};
  return box;
}

void print(const session::Plan& plan) {
  const session::PeopleReport& people = plan.people;
  std::printf("%zu %s in %llu frames, at most %zu at once\n", people.people.size(),
              people.people.size() == 1 ? "person" : "people",
              static_cast<unsigned long long>(people.frames), people.most_at_once);
  for (const session::PersonPath& p : people.people)
    std::printf("person %d: %.1f to %.1f s, %.2f m high, walked %.1f m\n", p.id, p.first_s,
                p.last_s, p.height_m, p.length_m);
  for (std::size_t i = 0; i < plan.places.size(); ++i) {
    const plan::FreePlace& p = plan.places[i];
    std::printf(
        "place %zu: %.2f %.2f m, turned by %.0f deg: %.0f %% of it seen, %.0f %% of its "
        "shadow on free floor, %.2f m to the nearest path\n",
        i + 1, p.at_m.x(), p.at_m.y(), p.yaw_rad / kDeg, 100 * p.visible_share,
        100 * p.shadow_share, p.path_m);
  }
  if (!people.error) return;
  const measure::PeopleErrors& e = *people.error;
  std::printf(
      "place on the floor: %.0f mm RMS, 95 %% within %.0f mm; NEES %.1f (2); missed %.1f %%, "
      "false %.1f %%; %d swaps and %d new tracks in %d crossings\n",
      e.rms_mm, e.p95_mm, e.nees, e.missed_pct, e.false_pct, e.swaps, e.broken, e.crossings);
}

Result<nlohmann::json> make(const PlanArguments& arguments) {
  MIXRIG_ASSIGN(session::SessionOptions session_arguments, session_options(arguments.session));
  MIXRIG_TRY(check_output_folder(arguments.out, session::kPlanReport, Force::kChecked));
  session::PlanOptions options;
  options.out = arguments.out;
  if (!arguments.frames.empty()) {
    MIXRIG_ASSIGN(options.frames, parse_range(arguments.frames, "--frames"));
  }
  MIXRIG_ASSIGN(options.box, parse_box(arguments.box));
  options.places = arguments.suggest;
  options.placing.path_margin_m = arguments.margin_m;
  const StopOnSignal signals;
  SystemClock clock;
  session_arguments.clock = &clock;
  session_arguments.stop = options.stop = &StopOnSignal::flag();
  MIXRIG_ASSIGN(const auto session, opened_session(session_arguments));
  MIXRIG_ASSIGN(const session::Plan plan,
                session::make_plan(*session, options, clock, progress_bar()));
  print(plan);
  if (options.places > 0 && plan.places.empty())
    std::printf("no place: the floor is not free for such a box, or people walk there\n");
  return with_end(session::to_json(plan), arguments.out, "look at " + arguments.out + "/plan.png");
}

}  // namespace

void add_plan_command(Command app, Context& context) {
  auto arguments = std::make_shared<PlanArguments>();
  Command command = app.add_subcommand("plan", "where people went on the floor");
  add_session_options(command, arguments->session);
  command.add_option("--frames", arguments->frames,
                     "FIRST-LAST; all after the learned ones if not given");
  command.add_option("--suggest", arguments->suggest, "number of places for an object")
      .range(0, 100);
  command.add_option("--box", arguments->box, "--suggest: width,depth,height of it in metres")
      .show_default();
  command
      .add_option("--margin", arguments->margin_m,
                  "--suggest: metres between it and the middle of who walks")
      .range(0.0, 5.0)
      .show_default();
  command.add_option("OUT", arguments->out, "folder to write, new or made by an earlier plan")
      .required();
  command.callback(
      [&context, arguments] { context.action = [arguments] { return make(*arguments); }; });
}

}  // namespace mixrig::tools
