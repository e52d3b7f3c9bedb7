// SPDX-License-Identifier: Apache-2.0
// mixrig explain: the passes of a scene, with reason, size and measured cost.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "host/run/explain/explain.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

Result<nlohmann::json> explain(const SessionArguments& arguments, int frames) {
  MIXRIG_ASSIGN(const session::SessionOptions options, session_options(arguments));
  MIXRIG_ASSIGN(const auto session, opened_session(options));
  MIXRIG_TRY(check_extras(session->scene));
  const SystemClock clock;
  MIXRIG_ASSIGN(const session::Explanation explanation,
                session::explain(*session, frames, run_extras(), clock, progress_bar()));
  std::fputs(session::to_text(explanation).c_str(), stdout);
  nlohmann::json json = session::to_json(explanation);
  print_notes(session->scene, json);
  return json;
}

}  // namespace

void add_explain_command(Command app, Context& context) {
  struct Arguments {
    SessionArguments session;
    int frames = 10;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command =
      app.add_subcommand("explain", "show which passes a scene runs, why, and their cost");
  add_session_options(command, arguments->session);
  command.add_option("--frames", arguments->frames, "number of frames composited to measure")
      .range(1, 10000);
  command.callback([&context, arguments] {
    context.action = [arguments] { return explain(arguments->session, arguments->frames); };
  });
}

}  // namespace mixrig::tools
