// SPDX-License-Identifier: Apache-2.0
// mixrig scan: a panorama of the room from a sweep of the head, recorded or driven now, or the
// empty room of one view from frames of a take; the camera may move where they have poses; or
// several panoramas joined.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>

#include <nlohmann/json.hpp>

#include "hal/base/order_statistics.h"
#include "hal/base/output_folder.h"
#include "host/capture/capture/calibrated_source.h"
#include "host/capture/capture/unwrapped_source.h"
#include "host/capture/take/take_source.h"
#include "host/pose/source/fixed_poses.h"
#include "host/room/background/learn.h"
#include "host/room/sweep/live_scan.h"
#include "host/room/sweep/room_scan.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"
#include "host/tools/options.h"
#include "host/tools/room/room_report.h"
#include "host/tools/room/scan_merge.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

struct ScanArguments {
  SessionArguments session;
  std::string take, frames, out, rig, field;
  double overlap = 0.1;
  double modulation_mhz = 0;
  int view_frames = 4, most_views = 0, height_px = 720;
  bool evaluate = false, no_align = false;
  bool keep_sweep = false, no_bracket = false;
  ScanMergeOptions merge;
};

constexpr double kWholeField = 5e-4;  ///< share of the field that is not worth a line

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

nlohmann::json errors_json(const model::StaticBackground& background) {
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

/// The room of a sweep that lies in a folder.
Result<nlohmann::json> model_room(const ScanArguments& arguments, const std::filesystem::path& take,
                                  const std::filesystem::path& calibration) {
  session::RoomScanOptions options;
  options.take = take, options.calibration = calibration;
  options.evaluate = arguments.evaluate, options.align = !arguments.no_align;
  options.panorama.height_px = arguments.height_px;
  options.modulation_hz = 1e6 * arguments.modulation_mhz;
  options.threads = arguments.session.threads;
  if (!arguments.field.empty()) {
    MIXRIG_ASSIGN(options.field_deg, parse_size(arguments.field, "--field"));
  }
  MIXRIG_ASSIGN(const session::RoomScan room, session::scan_room(options));
  const SystemClock clock;
  const HostTime begin = clock.now();
  MIXRIG_TRY(session::save_room(room, options.calibration, arguments.out));
  return with_end(room_report(room, seconds(clock.now() - begin)), arguments.out,
                  "mixrig info " + arguments.out);
}

Result<nlohmann::json> scan_sweep(const ScanArguments& arguments) {
  return model_room(arguments, arguments.take, arguments.session.calibration);
}

/// Prints the plan of a sweep before the head turns for minutes.
void print_plan(const session::LiveScan& plan) {
  std::printf("%d views", plan.planned);
  if (plan.resumed > 0) std::printf(", %d of them from an earlier run", plan.resumed);
  std::printf("\n");
  if (plan.covered_share < 1 - kWholeField)
    std::printf("the limits of the unit or the number of views leave out %.1f %% of the field\n",
                100 * (1 - plan.covered_share));
  std::fflush(stdout);
}

Result<session::LiveScan> drive_sweep(const ScanArguments& arguments) {
  session::LiveScanOptions options;
  options.rig = arguments.rig, options.calibration = arguments.session.calibration;
  options.kinds = source_kinds();
  options.out = arguments.out, options.overlap = arguments.overlap;
  options.view_frames = arguments.view_frames;
  options.most_views = arguments.most_views;
  options.bracket = !arguments.no_bracket;
  if (!arguments.field.empty()) {
    MIXRIG_ASSIGN(options.field_deg, parse_size(arguments.field, "--field"));
  }
  std::optional<Progress> bar;
  options.planned = [&](const session::LiveScan& plan) {
    print_plan(plan);
    bar.emplace("sweep", plan.planned);
    bar->step(plan.views);
  };
  options.progress = [&](int done, int, Duration left) { bar->step(done, seconds(left)); };
  SystemClock clock;
  const StopOnSignal signals;
  return session::sweep_room(options, StopOnSignal::flag(), clock);
}

Result<nlohmann::json> scan_rig(const ScanArguments& arguments) {
  if (arguments.evaluate)
    return Error{ErrorCode::kUsage, "--evaluate judges a recorded sweep: give it with --take"};
  MIXRIG_ASSIGN(const session::LiveScan scan, drive_sweep(arguments));
  if (scan.stopped)
    return Error{ErrorCode::kDevice, "stopped after " + std::to_string(scan.views) + " of " +
                                         std::to_string(scan.planned) +
                                         " views, which are kept in '" + scan.sweep.string() +
                                         "': the same command goes on with the next"};
  std::printf("%.1f s for %d views\n", scan.seconds, scan.views - scan.resumed);
  MIXRIG_ASSIGN(nlohmann::json report, model_room(arguments, scan.sweep, scan.calibration));
  report["sweep"] = {{"seconds", scan.seconds},
                     {"resumed", scan.resumed},
                     {"bracketed", scan.bracketed},
                     {"restarts", scan.restarts},
                     {"covered_pct", 100 * scan.covered_share}};
  std::error_code ignored;  // what remains can be removed by hand
  if (!arguments.keep_sweep) std::filesystem::remove_all(scan.sweep, ignored);
  return report;
}

Result<nlohmann::json> scan_still(const ScanArguments& arguments) {
  if (arguments.evaluate)
    return Error{ErrorCode::kUsage, "--evaluate judges a sweep: leave --frames out"};
  MIXRIG_ASSIGN(const auto size, view_size(arguments.session));
  MIXRIG_ASSIGN(const FrameRange range, parse_range(arguments.frames, "--frames"));
  MIXRIG_ASSIGN(auto recorded, take::open_take_source(arguments.take));
  const std::filesystem::path calibration =
      arguments.session.calibration.empty() ? recorded->info().calibration
                                            : std::filesystem::path(arguments.session.calibration);
  MIXRIG_ASSIGN(auto calibrated, capture::with_calibration(std::move(recorded), calibration));
  const auto source = capture::without_wrapped_depth(std::move(calibrated));
  MIXRIG_ASSIGN(const auto setup, session::setup_of(source->info(), size));
  const auto poses = pose::make_own_poses(true, source->info().moves);
  MIXRIG_ASSIGN(const model::StaticBackground background,
                session::learn_background(*source, setup, range, backend_choice(arguments.session),
                                          progress_bar(), poses.get()));
  MIXRIG_TRY(model::save(background, arguments.out));
  print(background);
  return with_end(errors_json(background), arguments.out,
                  "name it in scene.toml: background.model = \"" + arguments.out + "\"");
}

Result<nlohmann::json> scan(const ScanArguments& arguments) {
  if (arguments.height_px % 2 != 0)
    return Error{ErrorCode::kUsage,
                 "--height must be even: a row for each elevation, twice as "
                 "many columns"};
  const auto given = [](const std::string& option) { return option.empty() ? 0 : 1; };
  const bool merges = !arguments.merge.rooms.empty();
  if (given(arguments.rig) + given(arguments.take) + (merges ? 1 : 0) != 1)
    return Error{ErrorCode::kUsage,
                 "scan: give one of --rig (sweep now), --take (a recorded sweep; with --frames "
                 "FIRST-LAST the empty room of one view) and --merge (scanned rooms)"};
  if (!arguments.frames.empty() && arguments.take.empty())
    return Error{ErrorCode::kUsage, "--frames names frames of --take: give the take"};
  if (merges) return scan_merge(arguments.merge, arguments.out, arguments.session.threads);
  if (!arguments.merge.near.empty())
    return Error{ErrorCode::kUsage, "--near is for --merge alone: leave it out"};
  if (arguments.out.empty())
    return Error{ErrorCode::kUsage, "scan: give OUT, the background folder to write"};
  if (!arguments.rig.empty()) return scan_rig(arguments);
  const bool is_still = !arguments.frames.empty();
  MIXRIG_TRY(check_output_folder(arguments.out, is_still ? "background.toml" : "manifest.toml",
                                 Force::kChecked));
  return is_still ? scan_still(arguments) : scan_sweep(arguments);
}

void add_scan_sweep_options(Command command, ScanArguments& arguments) {
  command.add_option("--field", arguments.field,
                     "Pan x tilt to cover, up to 360x180 degrees, 270x180 if not given; --take: "
                     "what the sweep was to cover, so that what it lacks is named");
  command
      .add_option("--overlap", arguments.overlap,
                  "--rig: share of a view that its neighbours see too")
      .show_default()
      .range(0.0, 0.9);
  command
      .add_option("--views", arguments.most_views,
                  "--rig: at most so many views, of a lower field where they do not cover it; 0: "
                  "as many as it takes")
      .show_default()
      .range(0, 1000);
  command.add_option("--view-frames", arguments.view_frames, "--rig: frames of each view")
      .show_default()
      .range(1, 1000);
  command
      .add_option("--height", arguments.height_px,
                  "Rows of the panorama of a sweep; it has twice as many columns")
      .show_default()
      .range(90, 1440);
  command
      .add_option("--modulation", arguments.modulation_mhz,
                  "MHz of a phase camera: the light that walls throw on each other is taken out of "
                  "a sweep's distances; 0: it is left in")
      .show_default()
      .range(0.0, 1000.0);
  command.add_flag("--no-bracket", arguments.no_bracket,
                   "--rig: one exposure only, also where views saturate or are dark");
  command.add_flag("--keep-sweep", arguments.keep_sweep,
                   "--rig: leave OUT.sweep, a take for scan --take, beside the room");
}

}  // namespace

void add_scan_command(Command app, Context& context) {
  auto arguments = std::make_shared<ScanArguments>();
  Command command = app.add_subcommand(
      "scan",
      "a panorama of the room from a sweep of the head, or the empty room from frames of a take; "
      "the camera may move where they have poses");
  command.add_option("--rig", arguments->rig,
                     "rig.toml: sweep its head now; views are kept in OUT.sweep until the room is "
                     "written, and the same command goes on after an interruption");
  add_scan_sweep_options(command, *arguments);
  add_take_option(command, arguments->take, "Recorded sweep, frames with poses, or empty frames");
  command.add_flag("--evaluate", arguments->evaluate, "Hold a sweep's room against its truth");
  command.add_flag("--no-align", arguments->no_align,
                   "A sweep: take the angles of the unit as they are");
  command.add_option("--frames", arguments->frames,
                     "--take: FIRST-LAST that show no person, for the empty room of one view");
  command.add_option("--merge", arguments->merge.rooms,
                     "A B [C D] OUT: rooms of one place, scanned from several positions, become "
                     "one. OUT is required: the last word is not a room");
  command.add_option("--near", arguments->merge.near,
                     "--merge: about where B stood in A's axes, where several answers fit: \"x y z "
                     "yaw\" in metres and degrees");
  command.add_option("OUT", arguments->out,
                     "REQUIRED, also with --merge: background folder to write");
  command.add_option("--size", arguments->session.size, "WxH of the view, if not the take's");
  add_calibration_option(command, arguments->session);
  add_backend_options(command, arguments->session);
  command.callback(
      [&context, arguments] { context.action = [arguments] { return scan(*arguments); }; });
}

}  // namespace mixrig::tools
