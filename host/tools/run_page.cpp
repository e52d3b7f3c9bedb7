// SPDX-License-Identifier: Apache-2.0
#include "host/tools/run_page.h"

#include <cstdio>

#include "host/session/played_source.h"
#include "host/session/scene_follower.h"
#include "host/tools/count_signals.h"

namespace mixrig::tools {

void add_page_options(Command command, PageArguments& arguments) {
  command
      .add_option("--page", arguments.listen,
                  "serve the operator's page at ADDRESS:PORT, 127.0.0.1:8437 if none is given "
                  "(port 0: one that is free); a recording is played at its rate, again and again")
      .value_if_left_out("127.0.0.1:8437");
  command
      .add_option("--record-to", arguments.takes,
                  "folder that the page's recordings are written to")
      .show_default();
}

Result<PageRun> open_page(const PageArguments& arguments, session::Session& session, Clock& clock,
                          session::RunOptions& options) {
  MIXRIG_ASSIGN(const page::Listen listen, page::parse_listen(arguments.listen));
  const bool live = session.source->info().frames == capture::kEndless;
  if (!live) session.source = session::played(std::move(session.source), clock);
  options.judge = false;
  options.scene = std::make_shared<session::SceneFollower>(session, true);
  PageRun run;
  std::atomic<int>* const requests =
      options.watch_room.value_or(true) ? &CountSignals::count() : nullptr;
  run.desk = std::make_unique<session::OperatorDesk>(
      session, options.scene, clock,
      session::DeskOptions{.takes = arguments.takes, .requests = requests, .live = live});
  MIXRIG_ASSIGN(run.server, page::Server::start(*run.desk, clock, listen));
  options.sinks.push_back(run.desk->make_sink());
  options.sinks.push_back(run.server->make_sink());
  std::fprintf(stderr, "page: %s\n", run.server->url().c_str());
  return run;
}

}  // namespace mixrig::tools
