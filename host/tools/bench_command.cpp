// SPDX-License-Identifier: Apache-2.0
// mixrig bench: speed against error, as table, JSON and plot.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "host/image_io/image_io.h"
#include "host/session/bench.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

Result<nlohmann::json> bench(const session::BenchOptions& options) {
  const SystemClock clock;
  MIXRIG_ASSIGN(const std::vector<session::Rung> rungs,
                session::bench(options, clock, progress_bar()));
  MIXRIG_TRY(image_io::write_png(options.folder / "speed_against_error.png",
                                 report::draw(session::plot_of(rungs), {1100, 720}).view()));
  std::fputs(session::to_table(rungs).c_str(), stdout);
  return session::to_json(rungs);
}

}  // namespace

void add_bench_command(Command app, Context& context) {
  struct Arguments {
    std::string out = "out/bench";
    session::BenchOptions options;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command =
      app.add_subcommand("bench", "measure speed against error in the virtual studio");
  command.add_option("--out", arguments->out, "folder of the plot and the reused takes")
      .show_default();
  command.add_option("--seed", arguments->options.seed, "of the studio").show_default();
  command.add_flag("--quick", arguments->options.quick, "half the size, fewer frames");
  command.callback([&context, arguments] {
    arguments->options.folder = arguments->out;
    context.action = [arguments] { return bench(arguments->options); };
  });
}

}  // namespace mixrig::tools
