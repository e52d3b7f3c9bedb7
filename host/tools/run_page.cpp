// SPDX-License-Identifier: Apache-2.0
#include "host/tools/run_page.h"

#include <cstdio>
#include <filesystem>

#include "host/capture/open/played_source.h"
#include "host/run/controls/scene_follower.h"

namespace mixrig::tools {

void add_page_options(Command command, PageArguments& arguments) {
  command
      .add_option("--page", arguments.listen,
                  "serve the operator's page at ADDRESS:PORT, 127.0.0.1:8437 if none is given "
                  "(port 0: one that is free); a recording is played at its rate, again and again")
      .value_if_left_out("127.0.0.1:8437");
  command.add_option("--page-proxy", arguments.proxied,
                     "HOST by which a reverse proxy on this machine serves the page by https; "
                     "needs --page");
  command.add_option("--page-token", arguments.token_file,
                     "FILE with the token that the page then asks for on this machine, too; it is "
                     "made where there is none, and renewed when it is removed; needs --page");
  command
      .add_option("--record-to", arguments.takes,
                  "folder that the page's recordings are written to")
      .show_default();
  command
      .add_option("--osc-in", arguments.osc_in,
                  "take OSC from control surfaces at [ADDRESS:]PORT, 127.0.0.1:8438 if none is "
                  "given; needs --page")
      .value_if_left_out("8438");
}

Result<PageRun> open_page(const PageArguments& arguments, session::Session& session, Clock& clock,
                          session::RunParts& parts) {
  MIXRIG_ASSIGN(page::Listen listen, page::parse_listen(arguments.listen));
  if (!arguments.proxied.empty()) MIXRIG_TRY(page::check_proxied(arguments.proxied));
  listen.proxied = arguments.proxied;
  listen.token_file = arguments.token_file;
  std::optional<page::Listen> osc;
  if (arguments.takes_osc) {
    MIXRIG_ASSIGN(osc, page::parse_osc_listen(arguments.osc_in));
    osc->token_file = arguments.token_file;
  }
  std::error_code code;
  if (std::filesystem::exists(arguments.takes, code) &&
      !std::filesystem::is_directory(arguments.takes, code))
    return Error{ErrorCode::kUsage,
                 "--record-to '" + arguments.takes + "' is a file: name a folder"};
  const bool live = session.source->info().is_live();
  if (!live) session.source = session::played(std::move(session.source), clock);
  parts.scene = std::make_shared<session::SceneFollower>(session, true);
  PageRun run;
  run.desk = std::make_unique<session::OperatorDesk>(
      session, parts.scene, *parts.orders, clock,
      session::DeskOptions{
          .takes = arguments.takes, .segment_s = arguments.segment_s, .live = live});
  MIXRIG_ASSIGN(run.server, page::Server::start(*run.desk, *parts.orders, clock, listen, osc));
  parts.sinks.push_back(run.desk->make_sink());
  parts.sinks.push_back(run.server->make_sink());
  std::fprintf(stderr, "page: %s\n", run.server->url().c_str());
  if (!listen.token_file.empty())
    std::fprintf(stderr, "page: add ?token= and the token in %s\n", listen.token_file.c_str());
  if (osc) std::fprintf(stderr, "osc: %s\n", run.server->osc_text().c_str());
  return run;
}

}  // namespace mixrig::tools
