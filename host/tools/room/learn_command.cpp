// SPDX-License-Identifier: Apache-2.0
// mixrig learn: a map of the room from the pictures of a take whose camera moves.
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "extras/map/learn/map_learn.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

struct LearnArguments {
  std::string take, out, calibration, camera = "fisheye";
  int threads = 0;
};

void print_learned(const nlohmann::json& report) {
  std::printf("%zu of %zu pictures have a pose, %zu key pictures, %zu places, residual %.2f px\n",
              report["poses"].get<std::size_t>(), report["pictures"].get<std::size_t>(),
              report["keys"].get<std::size_t>(), report["points"].get<std::size_t>(),
              report["residual_px"].get<double>());
  if (report["scale"] == "metric")
    std::printf("scale by depth: sigma %.2f %% from %d distances\n",
                report["scale_sigma_pct"].get<double>(), report["scale_measurements"].get<int>());
  else
    std::printf("scale unknown: the extent of the path is 1\n");
  if (report.contains("rms_mm"))
    std::printf(
        "error of the camera after %s alignment: %.2f mm RMS (%.2f %% of the path's extent of "
        "%.3f m), 95 %% within %.2f mm, %.4f deg RMS\n",
        report["aligned"].get<std::string>().c_str(), report["rms_mm"].get<double>(),
        report["rms_pct"].get<double>(), report["extent_m"].get<double>(),
        report["p95_mm"].get<double>(), report["rms_deg"].get<double>());
}

Result<nlohmann::json> learn(const LearnArguments& arguments) {
  session::MapLearnOptions options;
  options.take = arguments.take, options.out = arguments.out;
  options.calibration = arguments.calibration;
  options.camera = arguments.camera == "target" ? session::TrackedCamera::kTarget
                                                : session::TrackedCamera::kFisheye;
  options.threads = arguments.threads;
  std::unique_ptr<Progress> bar;
  options.progress = [&bar](int done, int total) {
    if (!bar) bar = std::make_unique<Progress>("pictures", total);
    bar->step(done);
  };
  auto report = session::learn_map(options);
  bar.reset();
  if (!report) return report;
  print_learned(*report);
  return with_end(*std::move(report), arguments.out,
                  "mixrig track --map " + arguments.out + " --take TAKE poses.txt");
}

}  // namespace

void add_learn_command(Command app, Context& context) {
  auto arguments = std::make_shared<LearnArguments>();
  Command command = app.add_subcommand(
      "learn", "a map of the room from the pictures of a take whose camera moves");
  add_take_option(command, arguments->take, "whose camera moves").required();
  command.add_option("--camera", arguments->camera, "whose pictures")
      .one_of({"fisheye", "target"})
      .show_default();
  command.add_option("--calibration", arguments->calibration,
                     "calibration.toml; if not given, the take's");
  command.add_option("--threads", arguments->threads, "0: one per core").non_negative();
  command.add_option("OUT", arguments->out, "folder of the map").required();
  command.callback(
      [&context, arguments] { context.action = [arguments] { return learn(*arguments); }; });
}

}  // namespace mixrig::tools
