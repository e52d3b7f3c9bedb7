// SPDX-License-Identifier: Apache-2.0
// mixrig studio: renders a take with truth in the virtual studio.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>

#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/output_folder.h"
#include "host/room/scan/sweep_plan.h"
#include "host/tools/command.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"
#include "studio/io/board_set.h"
#include "studio/io/board_source.h"
#include "studio/io/studio_take.h"
#include "studio/rig.h"

namespace mixrig::tools {
namespace {

struct StudioArguments {
  std::string out, scenario = "walk", rig = "kinect2", size = "1280x1024", format = "png";
  std::string board = "checkerboard";
  int seed = 1, frames = 60, threads = 0, views = 0;
  bool pan_tilt = false, clear_floor = false, hand = false;
  double tremor_mm = 0, rest_s = 0.8, move_s = 0.8;
  double bend_mm = 0, tolerance = 0;
  std::optional<double> depth_error_mm, lens_error_px;
  bool plain = false, cold = false;
  int people = 1;
  std::string only, without;
  std::string field = "270x180";
  double overlap = 0.1;
  int frames_per_view = 4;
  bool sweep_people = false, sweep_crossing = false;
  bool window = false, sweep_bracket = false;
  std::string eye, look_at, object, dim, refocus;
  std::optional<double> pan_deg;
  double zoom = 1, aperture_mm = 0, focus_m = 3;
  bool fisheye = false, raw = false, force = false;
  std::string fisheye_size = "640x512";
  studio::Day day;
};

constexpr const char* kBoardScenario = "board";
constexpr double kLensError_px = 0.3;  ///< of the judged look, at the corners

/// The judged look has every switch on but the warm-up: rigs are calibrated and used warm.
Result<studio::Realism> realism_of(const StudioArguments& arguments) {
  if (arguments.plain && (arguments.cold || !arguments.only.empty() || !arguments.without.empty()))
    return Error{ErrorCode::kUsage, "--plain excludes --only, --without and --cold: drop one"};
  if (arguments.plain) return studio::Realism{};
  studio::Realism on = studio::Realism::all();
  on.warm_up = false;
  if (!arguments.only.empty()) {
    MIXRIG_ASSIGN(on, studio::parse_realism(arguments.only));
  }
  on.warm_up = on.warm_up || arguments.cold;
  MIXRIG_ASSIGN(const studio::Realism off, studio::parse_realism(arguments.without));
  return studio::minus(on, off);
}

/// "X,Y,Z" in metres; nothing for an empty text.
Result<std::optional<Eigen::Vector3d>> parse_place(const std::string& text,
                                                   const std::string& option) {
  if (text.empty()) return std::optional<Eigen::Vector3d>();
  Eigen::Vector3d place;
  char end = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &place.x(), &place.y(), &place.z(), &end) != 3 ||
      !place.allFinite())
    return Error{ErrorCode::kUsage, option + " '" + text + "': write three numbers: A,B,C"};
  return std::optional(place);
}

/// Two numbers, as `form` names them; nothing for an empty text.
Result<std::optional<Eigen::Vector2d>> parse_two(const std::string& text, const std::string& option,
                                                 const char* form) {
  if (text.empty()) return std::optional<Eigen::Vector2d>();
  auto place = parse_place(text + ",0", option);
  if (!place) return Error{ErrorCode::kUsage, option + " '" + text + "': write " + form};
  return std::optional<Eigen::Vector2d>((*place)->head<2>());
}

/// The head's views of a sweep with the depth camera of the rig as designed.
Result<studio::Sweep> sweep_of(const StudioArguments& arguments, studio::RigPreset rig) {
  constexpr double kMostPan_deg = 180, kMostTilt_deg = 90;
  MIXRIG_ASSIGN(const Size field_deg, parse_size(arguments.field, "--field"));
  const studio::Optics tof = studio::tof_sensor(rig).optics;
  model::SweepTask task;
  task.field_pan_rad = field_deg.width * kDeg, task.field_tilt_rad = field_deg.height * kDeg;
  task.camera_pan_rad = 2 * std::atan(0.5 * tof.size_px.width / tof.fx_px);
  task.camera_tilt_rad = 2 * std::atan(0.5 * tof.size_px.height / tof.fy_px);
  task.overlap = arguments.overlap;
  task.most_views = arguments.views;
  task.most_pan_rad = kMostPan_deg * kDeg, task.most_tilt_rad = kMostTilt_deg * kDeg;
  MIXRIG_ASSIGN(const model::SweepPlan plan, model::plan_sweep(task));
  studio::Sweep sweep;
  for (const model::HeadView& view : plan.views)
    sweep.views.push_back({view.pan_rad, view.tilt_rad});
  sweep.frames_per_view = arguments.frames_per_view;
  sweep.crossing = arguments.sweep_crossing;
  sweep.people = arguments.sweep_people || sweep.crossing;
  sweep.bracket = arguments.sweep_bracket;
  std::printf("%zu views, %.0f degrees high, %.1f %% of the field\n", plan.views.size(),
              plan.field_tilt_rad / kDeg, 100 * plan.covered_share);
  return sweep;
}

Result<studio::StudioOptions> options_of(const StudioArguments& arguments) {
  studio::StudioOptions options;
  MIXRIG_ASSIGN(options.scenario, studio::parse_scenario(arguments.scenario));
  MIXRIG_ASSIGN(const studio::RigWords rig, studio::parse_rig_words(arguments.rig));
  options.rig = rig.rig, options.second_tof = rig.second_tof;
  MIXRIG_ASSIGN(options.size_px, parse_size(arguments.size, "--size"));
  if (arguments.seed < 0) return Error{ErrorCode::kUsage, "--seed must not be negative"};
  options.seed = static_cast<unsigned>(arguments.seed);
  options.frames = arguments.frames;
  options.threads = arguments.threads;
  options.clear_floor = arguments.clear_floor;
  options.tolerance = arguments.tolerance;
  options.people = arguments.people;
  options.window = arguments.window;
  MIXRIG_ASSIGN(options.realism, realism_of(arguments));
  MIXRIG_ASSIGN(options.eye_m, parse_place(arguments.eye, "--eye"));
  MIXRIG_ASSIGN(options.look_at_m, parse_place(arguments.look_at, "--look-at"));
  MIXRIG_ASSIGN(options.object_m, parse_two(arguments.object, "--object", "X,Y in metres"));
  options.zoom = arguments.zoom;
  options.lens = {1e-3 * arguments.aperture_mm, arguments.focus_m};
  options.day = arguments.day;
  MIXRIG_ASSIGN(const auto dim, parse_place(arguments.dim, "--dim"));
  if (dim)  // a number beyond those of an int is no lamp either
    options.day.dim = {static_cast<int>(std::clamp(dim->x(), -1.0, 99.0)), dim->y(), dim->z()};
  MIXRIG_ASSIGN(const auto refocus, parse_two(arguments.refocus, "--refocus", "SECONDS,METRES"));
  if (refocus) options.refocus = {refocus->x(), refocus->y()};
  options.fisheye = arguments.fisheye;
  options.raw = arguments.raw;
  MIXRIG_ASSIGN(options.fisheye_px, parse_size(arguments.fisheye_size, "--fisheye-size"));
  if (arguments.pan_deg) options.pan_rad = 0.5 * *arguments.pan_deg * kDeg;
  if (options.scenario == studio::Scenario::kSweep) {
    MIXRIG_ASSIGN(options.sweep, sweep_of(arguments, options.rig));
    options.frames = static_cast<int>(options.sweep.views.size()) * options.sweep.frames_per_view;
  }
  return options;
}

Result<studio::BoardOptions> board_options_of(const StudioArguments& arguments) {
  studio::BoardOptions options;
  MIXRIG_ASSIGN(const studio::RigWords rig, studio::parse_rig_words(arguments.rig));
  options.rig = rig.rig, options.second_tof = rig.second_tof;
  MIXRIG_ASSIGN(options.size_px, parse_size(arguments.size, "--size"));
  MIXRIG_ASSIGN(options.board.kind, studio::parse_board(arguments.board));
  if (arguments.seed < 0) return Error{ErrorCode::kUsage, "--seed must not be negative"};
  options.seed = static_cast<unsigned>(arguments.seed);
  if (arguments.views != 0) options.views = arguments.views;
  options.threads = arguments.threads;
  options.pan_tilt = arguments.pan_tilt;
  options.board.bend_m = arguments.bend_mm / 1000;
  options.tolerance = arguments.tolerance;
  options.lens_error_px = arguments.lens_error_px.value_or(arguments.plain ? 0 : kLensError_px);
  if (arguments.depth_error_mm) options.depth_error_m = *arguments.depth_error_mm / 1000;
  options.hand.tremor_m = arguments.tremor_mm / 1000;
  options.hand.rest_s = arguments.rest_s;
  options.hand.move_s = arguments.move_s;
  if (!arguments.hand) return options;
  if (arguments.pan_tilt)
    return Error{ErrorCode::kUsage, "--hand moves the board, --ptu the cameras: drop one"};
  MIXRIG_ASSIGN(options.fisheye_px, parse_size(arguments.fisheye_size, "--fisheye-size"));
  return options;
}

Result<take::StreamFormat> format_of(const std::string& format) {
  if (format == "png") return take::StreamFormat::kPng;
  if (format == "mkv") return take::StreamFormat::kMatroska;
  return Error{ErrorCode::kUsage, "unknown --format \"" + format + "\": use png or mkv"};
}

/// A take of a board in the hands of a person, as long as the views take.
Result<nlohmann::json> render_hand(const StudioArguments& arguments,
                                   const studio::BoardOptions& options) {
  MIXRIG_ASSIGN(const take::StreamFormat format, format_of(arguments.format));
  const double seconds = options.views * (options.hand.rest_s + options.hand.move_s);
  const auto frames = static_cast<int>(std::lround(seconds * studio::kFrameRate_hz));
  Progress bar("studio", frames);
  const StopOnSignal signals;
  MIXRIG_ASSIGN(const studio::BoardInfo info,
                studio_io::write_board_take(
                    options, frames, arguments.out, format, [&](int n) { bar.step(n); },
                    &StopOnSignal::flag()));
  std::printf("%s: %s, %d frames of a board held at %d places\n", arguments.out.c_str(),
              info.name.c_str(), frames, options.views);
  return with_end({{"name", info.name}, {"frames", frames}}, arguments.out,
                  "mixrig calibrate views VIEWS --source " + arguments.out + " --board BOARD");
}

Result<nlohmann::json> render_board(const StudioArguments& arguments) {
  MIXRIG_ASSIGN(const studio::BoardOptions options, board_options_of(arguments));
  if (arguments.hand) return render_hand(arguments, options);
  Progress bar("studio", options.views);
  const StopOnSignal signals;
  MIXRIG_ASSIGN(const studio::BoardInfo info,
                studio_io::write_board_set(
                    options, arguments.out, [&](int n) { bar.step(n); }, &StopOnSignal::flag()));
  std::printf("%s: %s, %d views of a %s\n", arguments.out.c_str(), info.name.c_str(), options.views,
              std::string(studio::name(options.board.kind)).c_str());
  return with_end({{"name", info.name}, {"views", options.views}}, arguments.out,
                  "mixrig calibrate rig " + arguments.out);
}

Result<nlohmann::json> render(const StudioArguments& arguments) {
  MIXRIG_ASSIGN(const studio::StudioOptions options, options_of(arguments));
  MIXRIG_ASSIGN(const take::StreamFormat format, format_of(arguments.format));
  Progress bar("studio", options.frames);
  const StopOnSignal signals;
  MIXRIG_ASSIGN(
      const studio::StudioInfo info,
      studio_io::write_studio_take(
          options, arguments.out, format, [&](int n) { bar.step(n); }, &StopOnSignal::flag()));
  std::printf("%s: %s, %d frames of %dx%d, the first %d empty\n", arguments.out.c_str(),
              info.name.c_str(), info.frames, info.target.size_px.width, info.target.size_px.height,
              info.empty_frames);
  return with_end({{"name", info.name},
                   {"frames", info.frames},
                   {"empty_frames", info.empty_frames},
                   {"size", arguments.size}},
                  arguments.out, "mixrig run " + arguments.out + "/scene.toml --out FOLDER");
}

void add_board_options(Command command, StudioArguments& arguments) {
  const char* group = "Scenario board";
  const auto option = [&](const char* name, auto& value, const char* what) {
    command.add_option(name, value, what).group(group).show_default();
  };
  command
      .add_option("--views", arguments.views,
                  "Number of views of the board, 20 if not given, every fifth far off the axis; "
                  "scenario sweep: at most so many, of a lower field where they do not cover it")
      .group(group);
  option("--board", arguments.board, "checkerboard charuco");
  option("--bend", arguments.bend_mm, "Height of the board's middle above its edges, mm");
  command
      .add_option("--depth-error", arguments.depth_error_mm,
                  "Largest systematic depth error, mm; that of the takes if not given")
      .group(group);
  command
      .add_option(
          "--lens-error", arguments.lens_error_px,
          "Error of the target lens outside its model at the corners, px; 0.3 if not given, "
          "0 with --plain")
      .group(group);
  command.add_flag("--ptu", arguments.pan_tilt, "The board stands still, the pan-tilt unit turns")
      .group(group);
  command
      .add_flag("--hand", arguments.hand,
                "A take instead of a folder of views: a person takes the board from view to view")
      .group(group);
  option("--rest", arguments.rest_s, "--hand: seconds at each view");
  option("--move", arguments.move_s, "--hand: seconds from view to view");
  option("--tremor", arguments.tremor_mm, "--hand: of the hands, mm (sigma an axis)");
}

void add_sweep_options(Command command, StudioArguments& arguments) {
  const char* group = "Scenario sweep";
  const auto option = [&](const char* name, auto& value, const char* what) {
    command.add_option(name, value, what).group(group).show_default();
  };
  option("--field", arguments.field, "Pan x tilt to cover, whole degrees");
  option("--overlap", arguments.overlap, "Share of a view that its neighbours see too, 0 to 0.9");
  option("--view-frames", arguments.frames_per_view, "Frames of each view");
  command.add_flag("--walker", arguments.sweep_people, "A person walks from the second view on")
      .group(group);
  command
      .add_flag("--crossing", arguments.sweep_crossing,
                "A person crosses every second view, 0.7 s from one of its frames to the next")
      .group(group);
  command
      .add_flag(
          "--bracket", arguments.sweep_bracket,
          "Plates also at other exposures where they saturate or are dark, and the true light")
      .group(group);
}

void add_day_options(Command command, StudioArguments& arguments) {
  const char* group = "Another day than that of the scan";
  studio::Day& day = arguments.day;
  command.add_option("--crowd", day.crowd, "People who stand close before the camera, 0 to 8")
      .group(group);
  command.add_option("--lamps", day.lamp_level, "Level of all lamps, 0 to 2; 1 as scanned")
      .group(group);
  command.add_option("--lights-out", day.lights_out_s, "Seconds into the take: then lamps go off")
      .group(group);
  command
      .add_option("--dim", arguments.dim,
                  "LAMP,SECONDS,LEVEL: from then on that lamp, 1 to 4, has 0 to 2 times its light")
      .group(group);
  command.add_flag("--moved-chair", day.moved_chair, "The desk's chair stands elsewhere")
      .group(group);
}

/// Checks the options against the scenario. Errors: kUsage for an option of another scenario.
Result<void> check_scenario(const Command& command, const std::string& scenario) {
  constexpr std::array kOfBoard{"--board", "--bend", "--hand", "--depth-error", "--lens-error",
                                "--ptu",   "--rest", "--move", "--tremor"};
  constexpr std::array kOfSweep{"--field",  "--overlap",  "--view-frames",
                                "--walker", "--crossing", "--bracket"};
  const auto belongs = [](const char* option, const char* to) {
    return Error{ErrorCode::kUsage, std::string(option) + " is for --scenario " + to +
                                        ": choose that, or leave it out"};
  };
  const bool is_board = scenario == kBoardScenario, is_sweep = scenario == "sweep";
  for (const char* option : kOfBoard)
    if (!is_board && command.count(option) > 0) return belongs(option, kBoardScenario);
  for (const char* option : kOfSweep)
    if (!is_sweep && command.count(option) > 0) return belongs(option, "sweep");
  if (!is_board && !is_sweep && command.count("--views") > 0)
    return belongs("--views", "board or sweep");
  return {};
}

}  // namespace

void add_studio_command(Command app, Context& context) {
  auto arguments = std::make_shared<StudioArguments>();
  Command command =
      app.add_subcommand("studio", "render a take with ground truth in the virtual studio");
  command.add_option("OUT", arguments->out, "Folder of the take").required();
  command.add_flag("--force", arguments->force, "Replace the take or the views that OUT holds");
  const auto with_default = [&](const char* name, auto& value, const char* what) {
    command.add_option(name, value, what).show_default();
  };
  with_default("--scenario", arguments->scenario,
               "still walk talk pan sweep handheld pendulum carried edges far dark starts "
               "rounds board");
  with_default("--rig", arguments->rig,
               "sr3000 kinect2 helios2; RIG+SECOND has a second depth camera");
  with_default("--seed", arguments->seed, "Person, clothes, path, noise, pan-tilt unit");
  with_default("--tolerance", arguments->tolerance,
               "Deviation of lenses and mounting by seed: 0 none, 1 as manufactured");
  with_default("--frames", arguments->frames, "Length; the first 25 (at most half) are empty");
  with_default("--size", arguments->size, "Target camera, WxH");
  with_default("--format", arguments->format, "png or mkv");
  command.add_option("--threads", arguments->threads, "0: one per core");
  command.add_option("--aperture-mm", arguments->aperture_mm,
                     "The truth's composite through a thin lens of this aperture (slow; with "
                     "--plain); plates stay sharp. 0: a pinhole");
  command.add_option("--focus-m", arguments->focus_m, "Distance that is sharp through that lens");
  command.add_option("--refocus", arguments->refocus,
                     "SECONDS,METRES: from then on the plates' lens is sharp at so many metres");
  command.add_flag("--clear-floor", arguments->clear_floor,
                   "No chair at the desk: no furniture in the capture volume");
  command.add_option("--people", arguments->people, "1 to 3: the second sits, the third walks");
  command.add_flag("--window", arguments->window,
                   "A window by night in place of the middle picture: glass without depth");
  command.add_flag("--plain", arguments->plain,
                   "No imperfection but noise: none of the switches of realism");
  command.add_flag("--cold", arguments->cold,
                   "The depth camera was switched on 1 to 10 minutes ago: switch warm-up too");
  const std::string switches = studio::names_of(studio::Realism::all());
  command.add_option("--only", arguments->only, "Only these switches of realism: " + switches);
  command.add_option("--without", arguments->without, "All switches of realism but these");
  command.add_flag("--raw", arguments->raw,
                   "Rig kinect2: the sensor's raw pictures in place of depth; run decodes them");
  command.add_option("--eye", arguments->eye, "X,Y,Z of the camera at rest, metres, world");
  command.add_option("--look-at", arguments->look_at, "X,Y,Z that it looks at");
  command.add_option("--object", arguments->object, "X,Y of the virtual object on the floor");
  command.add_option("--pan", arguments->pan_deg, "Scenario pan: degrees from side to side, or 24");
  command
      .add_option(
          "--zoom", arguments->zoom,
          "The lens zooms in to this many times its focal length; the take has lens.csv and "
          "scene_zoom.toml")
      .show_default();
  command.add_flag(
      "--fisheye", arguments->fisheye,
      "The take has the fisheye's pictures, 10 Hz; in a sweep and in starts one for each frame");
  command.add_option("--fisheye-size", arguments->fisheye_size, "Of them, WxH");
  add_board_options(command, *arguments);
  add_sweep_options(command, *arguments);
  add_day_options(command, *arguments);
  command.callback([arguments, command, &context] {
    context.action = [arguments, command]() -> Result<nlohmann::json> {
      MIXRIG_TRY(check_scenario(command, arguments->scenario));
      const bool is_board = arguments->scenario == kBoardScenario;
      MIXRIG_TRY(check_output_folder(arguments->out, is_board ? "views.toml" : "take.toml",
                                     arguments->force ? Force::kYes : Force::kNo));
      return is_board ? render_board(*arguments) : render(*arguments);
    };
  });
}

}  // namespace mixrig::tools
