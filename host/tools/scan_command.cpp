// SPDX-License-Identifier: Apache-2.0
// mixrig scan: learns the empty room from frames of a take; the camera may move where they have
// poses.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>

#include <nlohmann/json.hpp>

#include "hal/base/order_statistics.h"
#include "host/capture/calibrated_source.h"
#include "host/pose/fixed_poses.h"
#include "host/session/learn.h"
#include "host/take/take_source.h"
#include "host/tools/command.h"
#include "host/tools/options.h"

namespace mixrig::tools {
namespace {

struct ScanArguments {
  SessionArguments session;
  std::string take, frames, out;
};

struct Coverage {
  double known_pct = 0;
  double median_sigma_mm = 0;
};

Coverage coverage_of(const model::StaticBackground& background) {
  std::vector<float> sigma_m;
  for (int y = 0; y < background.depth_m.height(); ++y)
    for (int x = 0; x < background.depth_m.width(); ++x)
      if (background.depth_m.row(y)[x] > 0.0F)
        sigma_m.push_back(background.depth_sigma_m.row(y)[x]);
  if (sigma_m.empty()) return {};
  return {100.0 * static_cast<double>(sigma_m.size()) /
              static_cast<double>(background.depth_m.size().area()),
          upper_median_in_place(std::span(sigma_m)) * 1e3};
}

/// Angle by which the camera looks down onto the floor, 0 for a level camera.
double look_down_deg(const geometry::Plane& floor) {
  return -std::asin(std::clamp(floor.normal.z(), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

nlohmann::json report_of(const model::StaticBackground& background) {
  const Coverage coverage = coverage_of(background);
  nlohmann::json report = {{"frames", background.frames},
                           {"size", std::to_string(background.view.size_px.width) + "x" +
                                        std::to_string(background.view.size_px.height)},
                           {"coverage_pct", coverage.known_pct},
                           {"median_sigma_mm", coverage.median_sigma_mm},
                           {"floor", nullptr}};
  if (const auto& floor = background.floor)
    report["floor"] = {{"normal", {floor->normal.x(), floor->normal.y(), floor->normal.z()}},
                       {"camera_height_m", floor->offset_m},
                       {"look_down_deg", look_down_deg(*floor)}};
  return report;
}

void print(const model::StaticBackground& background) {
  const Coverage coverage = coverage_of(background);
  std::printf("%d frames, %dx%d: depth known on %.1f %%, median sigma %.1f mm\n", background.frames,
              background.view.size_px.width, background.view.size_px.height, coverage.known_pct,
              coverage.median_sigma_mm);
  if (background.floor)
    std::printf("floor %.3f m below the camera, which looks down by %.1f degrees\n",
                background.floor->offset_m, look_down_deg(*background.floor));
  else
    std::printf("no floor found\n");
}

Result<nlohmann::json> scan(const ScanArguments& arguments) {
  MIXRIG_ASSIGN(const auto size, view_size(arguments.session));
  MIXRIG_ASSIGN(const session::FrameRange range, parse_range(arguments.frames, "--frames"));
  MIXRIG_ASSIGN(auto recorded, take::open_take_source(arguments.take));
  const std::filesystem::path calibration =
      arguments.session.calibration.empty() ? recorded->info().calibration
                                            : std::filesystem::path(arguments.session.calibration);
  MIXRIG_ASSIGN(const auto source, capture::with_calibration(std::move(recorded), calibration));
  MIXRIG_ASSIGN(const auto setup, session::setup_of(source->info(), size));
  const auto poses = pose::make_own_poses(true, source->info().moves);
  MIXRIG_ASSIGN(const model::StaticBackground background,
                session::learn_background(*source, setup, range, backend_choice(arguments.session),
                                          progress_bar(), poses.get()));
  MIXRIG_TRY(model::save(background, arguments.out));
  print(background);
  return report_of(background);
}

}  // namespace

void add_scan_command(Command app, Context& context) {
  auto arguments = std::make_shared<ScanArguments>();
  Command command = app.add_subcommand(
      "scan",
      "learn the empty room from frames of a take; the camera may move where they have poses");
  command.add_option("--static", arguments->take, "TAKE: folder or take.toml").required();
  command.add_option("--frames", arguments->frames, "FIRST-LAST that show the empty room")
      .required();
  command.add_option("OUT", arguments->out, "background folder to write").required();
  command.add_option("--size", arguments->session.size, "WxH of the view, if not the take's");
  add_calibration_option(command, arguments->session);
  add_backend_options(command, arguments->session);
  command.callback(
      [&context, arguments] { context.action = [arguments] { return scan(*arguments); }; });
}

}  // namespace mixrig::tools
