// SPDX-License-Identifier: Apache-2.0
// mixrig explain: what a scene makes run, why, at what size, and its measured cost.
#include <cstdio>
#include <memory>

#include "host/app/explain.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

Result<nlohmann::json> explain(const SessionWords& words, int frames) {
  MIXRIG_ASSIGN(const app::SessionOptions options, session_options(words));
  MIXRIG_ASSIGN(const auto session, app::open_session(options));
  const SystemClock clock;
  MIXRIG_ASSIGN(const app::Explanation explanation,
                app::explain(*session, frames, clock, progress_bar()));
  std::fputs(app::to_text(explanation).c_str(), stdout);
  return app::to_json(explanation);
}

}  // namespace

void add_explain_command(CLI::App& app, Context& context) {
  struct Words {
    SessionWords session;
    int frames = 10;
  };
  auto words = std::make_shared<Words>();
  CLI::App* command =
      app.add_subcommand("explain", "tell which passes a scene makes run, why, and their cost");
  add_session_options(*command, words->session);
  command->add_option("--frames", words->frames, "number of frames composited to measure")
      ->check(CLI::Range(1, 10000));
  command->callback([&context, words] {
    context.action = [words] { return explain(words->session, words->frames); };
  });
}

}  // namespace mixrig::tools
