// SPDX-License-Identifier: Apache-2.0
// Operator's page of `mixrig run`.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/operator/desk/operator_desk.h"
#include "host/operator/page/server.h"
#include "host/run/loop/run.h"
#include "host/tools/command_line.h"

namespace mixrig::tools {

struct PageArguments {
  bool serves = false;     ///< --page was given
  bool takes_osc = false;  ///< --osc-in was given
  double segment_s = 0;    ///< of the page's recordings
  std::string listen, proxied, token_file, takes = "recordings", osc_in;
};
/// Adds --page, --page-proxy, --page-token, --record-to and --osc-in.
void add_page_options(Command command, PageArguments& arguments);

/// Serves the page while the object lives.
struct PageRun {
  std::unique_ptr<session::OperatorDesk> desk;
  std::unique_ptr<page::Server> server;
};

/// Opens the page. From then on a recording is played at its rate, again and again. Adds sinks and
/// the scene's follower to `parts`, which have the orders, and prints the page's address on stderr.
/// `session`, `clock` and the orders outlive it. Errors: those of page::parse_listen,
/// page::check_proxied and page::Server::start.
Result<PageRun> open_page(const PageArguments& arguments, session::Session& session, Clock& clock,
                          session::RunParts& parts);

}  // namespace mixrig::tools
