// SPDX-License-Identifier: Apache-2.0
// mixrig bench: speed against error, as table, JSON and plot.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "host/image_io/image_io.h"
#include "host/session/bench.h"
#include "host/session/scan_bench.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

struct BenchArguments {
  std::string out = "out/bench", suite = "run", take, calibration;
  session::BenchOptions run;
};

/// Writes the plot, prints the table.
template <typename Rungs>
Result<nlohmann::json> reported(const Rungs& rungs, const std::filesystem::path& plot) {
  std::error_code ignored;  // writing says what is wrong
  std::filesystem::create_directories(plot.parent_path(), ignored);
  MIXRIG_TRY(image_io::write_png(plot, report::draw(session::plot_of(rungs), {1100, 720}).view()));
  std::fputs(session::to_table(rungs).c_str(), stdout);
  return session::to_json(rungs);
}

Result<nlohmann::json> bench(const BenchArguments& arguments) {
  const std::filesystem::path out = arguments.out;
  const SystemClock clock;
  if (arguments.suite == "run") {
    session::BenchOptions options = arguments.run;
    options.folder = out;
    MIXRIG_ASSIGN(const auto rungs, session::bench(options, clock, progress_bar()));
    return reported(rungs, out / "speed_against_error.png");
  }
  if (arguments.suite != "scan")
    return Error{ErrorCode::kUsage, "unknown --suite \"" + arguments.suite + "\": use run or scan"};
  if (arguments.take.empty())
    return Error{ErrorCode::kUsage,
                 "--suite scan needs --take: a sweep of mixrig studio --scenario sweep"};
  MIXRIG_ASSIGN(const auto rungs,
                session::scan_bench({arguments.take, arguments.calibration}, progress_bar()));
  return reported(rungs, out / "scan_time_against_error.png");
}

}  // namespace

void add_bench_command(Command app, Context& context) {
  auto arguments = std::make_shared<BenchArguments>();
  Command command =
      app.add_subcommand("bench", "measure speed against error in the virtual studio");
  command.add_option("--suite", arguments->suite, "run: the compositor; scan: a room from a sweep")
      .show_default();
  command.add_option("--out", arguments->out, "folder of the plot and the reused takes")
      .show_default();
  command.add_option("--seed", arguments->run.seed, "run: of the studio").show_default();
  command.add_flag("--quick", arguments->run.quick, "run: half the size, fewer frames");
  command.add_option("--take", arguments->take, "scan: the sweep, with its truth");
  command.add_option("--calibration", arguments->calibration,
                     "scan: in place of the true one of the take");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return bench(*arguments); }; });
}

}  // namespace mixrig::tools
