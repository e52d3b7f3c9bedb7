// SPDX-License-Identifier: Apache-2.0
// mixrig bench: speed against error, as table, JSON and plot.
#include <cstdio>
#include <memory>
#include <thread>

#include <nlohmann/json.hpp>

#include "hal/base/partial_path.h"
#include "host/judge/bench/bench.h"
#include "host/judge/bench/copy_rate.h"
#include "host/judge/bench/pairs.h"
#include "host/judge/bench/peers.h"
#include "host/judge/bench/scan_bench.h"
#include "host/judge/bench/suites.h"
#include "host/judge/latency/latency_bench.h"
#include "host/judge/latency/marker_bench.h"
#include "host/judge/latency/soak_bench.h"
#include "host/math/image_io/image_io.h"
#include "host/output/viewfinder/viewfinder.h"
#include "host/render/cpu/compositor_cpu.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

struct BenchArguments {
  std::string out = "out/bench", suite = "run", take, data, calibration, scene, size;
  bool view = false, grid = false;
  double minutes = 20, speed = 1;
  std::string rig = "rig.toml", region;
  int line = -1;
  double exposure_ms = 0, seconds = 20;
  session::BenchOptions run;
};

/// Writes the plot, prints the table.
template <typename Rungs>
Result<nlohmann::json> reported(const Rungs& rungs, const std::filesystem::path& plot) {
  std::error_code ignored;  // writing says what is wrong
  std::filesystem::create_directories(plot.parent_path(), ignored);
  MIXRIG_TRY(image_io::write_png(plot, report::draw(session::plot_of(rungs), {1100, 720}).view()));
  std::fputs(session::to_table(rungs).c_str(), stdout);
  return with_end(session::to_json(rungs), plot.string(), {});
}

/// One of bench::kSuites, or all of them: tables, OUT/SUITE.svg, OUT/suites.json.
Result<nlohmann::json> bench_suites(const BenchArguments& arguments) {
  const std::filesystem::path out = arguments.out;
  bench::SuiteOptions options{arguments.take, arguments.grid, arguments.run.quick};
  const bool pairs = !arguments.data.empty();
  if (pairs && arguments.suite != "refine")
    return Error{ErrorCode::kUsage, "--data is for --suite refine alone: leave it out"};
  if (options.take.empty() && !pairs) {
    session::BenchOptions wanted = arguments.run;
    wanted.folder = out;
    MIXRIG_ASSIGN(options.take,
                  session::bench_take(wanted, studio::RigPreset::kKinect2, progress_bar()));
  }
  std::error_code ignored;  // writing says what is wrong
  std::filesystem::create_directories(out, ignored);
  const double copy_bytes_per_s = bench::copy_bytes_per_s();
  nlohmann::json json = {{"take", pairs ? arguments.data : options.take.string()},
                         {"peers", bench::has_peers()},
                         {"cpu", render::cpu_vectors()},
                         {"threads", std::thread::hardware_concurrency()},
                         {"copy_gb_per_s", 1e-9 * copy_bytes_per_s},
                         {"suites", nlohmann::json::object()}};
  std::printf("one thread copies %.1f GB/s (read and written)\n", 1e-9 * copy_bytes_per_s);
  for (const std::string_view name : bench::kSuites) {
    if (arguments.suite != "all" && arguments.suite != name) continue;
    MIXRIG_ASSIGN(
        const bench::Suite suite,
        pairs ? bench::run_pairs(arguments.data, arguments.grid, options.quick, progress_bar())
              : bench::run_suite(std::string(name), options, progress_bar()));
    std::printf("\n%s", bench::to_table(suite, copy_bytes_per_s).c_str());
    json["suites"][suite.name] = bench::to_json(suite, copy_bytes_per_s);
    MIXRIG_TRY(write_file(out / (suite.name + ".svg"),
                          report::draw_svg(bench::plot_of(suite), {1100, 720})));
  }
  if (bench::has_peers()) std::puts("\n* other libraries");
  MIXRIG_TRY(write_file(out / "suites.json", json.dump(2) + "\n"));
  return with_end(std::move(json), out.string(), {});
}

Result<nlohmann::json> bench_latency(const BenchArguments& arguments) {
  if (arguments.take.empty())
    return Error{ErrorCode::kUsage, "--suite latency needs --take: a take of mixrig studio"};
  const std::filesystem::path out = arguments.out;
  const std::string scene =
      arguments.scene.empty() ? arguments.take + "/scene.toml" : arguments.scene;
  session::LatencyOptions options{.scene = scene, .take = arguments.take, .folder = out};
  if (!arguments.size.empty()) {
    MIXRIG_ASSIGN(options.view_size, parse_size(arguments.size, "--size"));
  }
  const StopOnSignal signals;
  SystemClock clock;
  output::RunOrders orders(StopOnSignal::flag());
  MIXRIG_ASSIGN(const auto bench, session::prepare_latency(options, clock, orders.stop()));
  viewfinder::ViewfinderReport shown;
  std::unique_ptr<output::CompositeSink> sink = session::make_log_sink(bench->log, clock);
  if (arguments.view) {
    MIXRIG_ASSIGN(sink,
                  viewfinder::Viewfinder::create(
                      {.title = "mixrig bench", .picture_px = bench->view_px, .log = &bench->log},
                      *bench->session->source, orders, clock, shown));
  }
  MIXRIG_ASSIGN(const session::LatencyReport report,
                session::run_latency(*bench, std::move(sink), orders, clock));
  MIXRIG_TRY(image_io::write_png(out / "delay.png",
                                 report::draw_bars(session::plot_of(report), {900, 320}).view()));
  std::fputs(session::to_table(report).c_str(), stdout);
  nlohmann::json json = session::to_json(report);
  if (arguments.view) json["driver"] = shown.driver;
  return with_end(std::move(json), out.string(), {});
}

/// "X,Y,W,H".
Result<session::MarkerRegion> parse_region(const std::string& text) {
  session::MarkerRegion r;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d,%d,%d,%d%c", &r.x, &r.y, &r.width, &r.height, &rest) == 4 &&
      r.x >= 0 && r.y >= 0 && r.width > 0 && r.height > 0)
    return r;
  return Error{ErrorCode::kUsage, "--region \"" + text + "\" is not X,Y,W,H in pixels"};
}

Result<nlohmann::json> bench_marker(const BenchArguments& arguments) {
  session::MarkerOptions options{.rig = arguments.rig,
                                 .scene = arguments.scene,
                                 .folder = arguments.out,
                                 .line = arguments.line,
                                 .exposure_s = 1e-3 * arguments.exposure_ms,
                                 .duration_s = arguments.seconds};
  if (!arguments.region.empty()) {
    MIXRIG_ASSIGN(options.region, parse_region(arguments.region));
  }
  const StopOnSignal signals;
  SystemClock clock;
  MIXRIG_ASSIGN(const session::MarkerReport report,
                session::measure_marker(options, clock, StopOnSignal::flag()));
  std::fputs(session::to_table(report).c_str(), stdout);
  return session::to_json(report);
}

Result<nlohmann::json> bench_soak(const BenchArguments& arguments) {
  if (arguments.take.empty())
    return Error{ErrorCode::kUsage, "--suite soak needs --take: a take to play"};
  session::SoakOptions options{
      .scene = arguments.scene.empty() ? arguments.take + "/scene.toml" : arguments.scene,
      .take = arguments.take,
      .folder = arguments.out,
      .duration_s = 60 * arguments.minutes,
      .speed = arguments.speed,
      .extras = run_extras()};
  if (!arguments.size.empty()) {
    MIXRIG_ASSIGN(options.view_size, parse_size(arguments.size, "--size"));
  }
  const StopOnSignal signals;
  MIXRIG_ASSIGN(const session::SoakReport report,
                session::soak(options, StopOnSignal::flag(), progress_bar()));
  std::fputs(session::to_table(report).c_str(), stdout);
  if (report.unexplained() <= 0) return session::to_json(report);
  return Error{ErrorCode::kData, "frames were lost that no counter explains: the table has them"};
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
  if (arguments.suite == "latency") return bench_latency(arguments);
  if (arguments.suite == "marker") return bench_marker(arguments);
  if (arguments.suite == "soak") return bench_soak(arguments);
  if (arguments.suite == "all" || bench::is_suite(arguments.suite)) return bench_suites(arguments);
  if (arguments.suite != "scan")
    return Error{ErrorCode::kUsage, "unknown --suite \"" + arguments.suite +
                                        "\": use run, warp, refine, key, mix, shadow, frame, "
                                        "memory, all, scan, latency, marker or soak"};
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
  command
      .add_option(
          "--suite", arguments->suite,
          "run: the compositor by size and depth camera; warp, refine, key, mix, shadow, frame, "
          "memory: each quality level of that stage (all: of all stages); scan: a room from a "
          "sweep; latency: the delay of a take that is played in real time as a rig; marker: that "
          "of a real rig, by a lamp on a trigger line; soak: a take played for long, again and "
          "again")
      .show_default();
  command.add_option("--out", arguments->out, "folder of the plot and the reused takes")
      .show_default();
  command.add_option("--seed", arguments->run.seed, "of the studio, for run, warp ... all")
      .show_default();
  command.add_option("--data", arguments->data,
                     "refine: folder with colour pictures and disparities (art, aloe, motorcycle) "
                     "in place of a take");
  command.add_flag("--grid", arguments->grid,
                   "warp, refine, key: other libraries at every setting of a grid");
  command.add_flag("--quick", arguments->run.quick,
                   "half the size, fewer frames, warp ... all: no gles");
  add_take_option(command, arguments->take,
                  "scan: the sweep, latency: the take, with their truth; soak: the take; warp ... "
                  "all: one of mixrig studio in place of the walk that is rendered");
  command.add_option("--minutes", arguments->minutes, "soak: of frames, by their own times")
      .range(0.05, 1440.0)
      .show_default();
  command
      .add_option("--speed", arguments->speed,
                  "soak: the clock of devices and pairing runs so many times as fast")
      .range(1.0, 1000.0)
      .show_default();
  command.add_option("--rig", arguments->rig, "marker: rig.toml").show_default();
  command.add_option("--line", arguments->line, "marker: trigger line of the lamp");
  command.add_option("--region", arguments->region,
                     "marker: X,Y,W,H of the lamp in the composite; all of it if not given");
  command.add_option("--exposure-ms", arguments->exposure_ms,
                     "marker: of the camera, in place of exposure_ms in rig.toml");
  command.add_option("--seconds", arguments->seconds, "marker: to look at the lamp")
      .range(2.0, 600.0)
      .show_default();
  command.add_option("--scene", arguments->scene,
                     "latency, soak, marker: in place of the take's scene.toml");
  command.add_option("--size", arguments->size, "latency, soak: WxH to composite at");
  command.add_flag("--view", arguments->view,
                   "latency: to the picture in the viewfinder's window; else to the composite");
  command.add_option("--calibration", arguments->calibration,
                     "scan: in place of the true one of the take");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return bench(*arguments); }; });
}

}  // namespace mixrig::tools
