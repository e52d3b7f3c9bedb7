// SPDX-License-Identifier: Apache-2.0
// mixrig bench: speed against error, as table, JSON and plot.
#include <cstdio>
#include <memory>

#include "host/app/bench.h"
#include "host/image_io/image_io.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

Result<nlohmann::json> bench(const app::BenchOptions& options) {
  const SystemClock clock;
  MIXRIG_ASSIGN(const std::vector<app::Rung> rungs, app::bench(options, clock, progress_bar()));
  MIXRIG_TRY(image_io::write_png(options.folder / "speed_against_error.png",
                                 app::draw(app::plot_of(rungs), {1100, 720}).view()));
  std::fputs(app::to_table(rungs).c_str(), stdout);
  return app::to_json(rungs);
}

}  // namespace

void add_bench_command(CLI::App& app, Context& context) {
  struct Words {
    std::string out = "out/bench";
    app::BenchOptions options;
  };
  auto words = std::make_shared<Words>();
  CLI::App* command =
      app.add_subcommand("bench", "measure speed against error in the virtual studio");
  command->add_option("--out", words->out, "folder for takes, which are used again, and the plot")
      ->capture_default_str();
  command->add_option("--seed", words->options.seed, "of the studio")->capture_default_str();
  command->add_flag("--quick", words->options.quick, "half the size, fewer frames");
  command->callback([&context, words, command] {
    if (!command->get_subcommands().empty()) return;  // `bench estimation` and its like
    words->options.folder = words->out;
    context.action = [words] { return bench(words->options); };
  });
}

}  // namespace mixrig::tools
