// SPDX-License-Identifier: Apache-2.0
// mixrig run: composites a scene into a take.
#include <cstdio>
#include <memory>

#include "host/app/run.h"
#include "host/tools/command.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

struct Words {
  SessionWords session;
  std::string out, frames, format = "png";
  bool layers = false, inspect = false;
};

Result<nlohmann::json> run(const Words& words) {
  MIXRIG_ASSIGN(app::SessionOptions session_words, session_options(words.session));
  app::RunOptions options;
  options.out = words.out;
  options.output.format = words.format == "video"  ? app::OutputFormat::kVideo
                          : words.format == "none" ? app::OutputFormat::kNone
                                                   : app::OutputFormat::kPng;
  options.output.layers = words.layers;
  options.output.inspect = words.inspect;
  if (!words.frames.empty()) {
    MIXRIG_ASSIGN(options.frames, parse_range(words.frames, "--frames"));
  }
  const StopOnSignal signals;
  SystemClock clock;
  session_words.clock = &clock;
  session_words.stop = options.stop = &StopOnSignal::flag();
  MIXRIG_ASSIGN(const auto session, app::open_session(session_words));
  MIXRIG_ASSIGN(const app::RunReport report, app::run(*session, options, clock, progress_bar()));
  std::fputs(app::to_table(report).c_str(), stdout);
  return app::to_json(report);
}

}  // namespace

void add_run_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* command = app.add_subcommand(
      "run", "composite a scene into a take; write pictures, contact sheet and report");
  add_session_options(*command, words->session);
  command->add_option("--out", words->out, "folder to write, new or made by an earlier run")
      ->required();
  command->add_option("--frames", words->frames,
                      "FIRST-LAST to composite; all after the learned ones if not given");
  command
      ->add_option("--format", words->format,
                   "of composite and mixed depth: png, video (Matroska, lossless) or none")
      ->check(CLI::IsMember({"png", "video", "none"}));
  command->add_flag("--layers", words->layers, "write segmented depth and matte as well");
  command->add_flag("--inspect", words->inspect, "write warped depth, key and light map as well");
  command->callback([&context, words] { context.action = [words] { return run(*words); }; });
}

}  // namespace mixrig::tools
