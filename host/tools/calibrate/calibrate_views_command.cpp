// SPDX-License-Identifier: Apache-2.0
// mixrig calibrate views: stills of a board by all cameras of a rig, as calibrate rig, tof and ptu
// read them.
#include <chrono>
#include <memory>

#include "hal/base/output_folder.h"
#include "host/capture/live/session/live_source.h"
#include "host/capture/open/open_source.h"
#include "host/capture/take/take_source.h"
#include "host/tools/calibrate/collect_views.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

struct ViewsArguments {
  std::string out, rig, take, board, turn;
  int views = 15, frames = 8, turn_views = 20;
  double rest_px = 0.25;
  bool force = false;
};

/// All cameras that views have: the first one, the fisheye, the depth camera; the head for its
/// angles.
Result<std::unique_ptr<capture::CaptureSource>> open_cameras(const std::string& rig_toml,
                                                             const std::atomic<bool>& stop,
                                                             Clock& clock) {
  MIXRIG_ASSIGN(live::RigConfig rig, live::read_rig(rig_toml));
  session::leave_out_cameras(rig, true);
  rig = session::without_idle_trigger(std::move(rig));
  MIXRIG_ASSIGN(live::Devices devices,
                live::open_devices(rig, session::device_opener(rig, source_kinds(), clock)));
  return live::make_live_source(std::move(rig), std::move(devices), stop, clock);
}

Result<CollectArguments> collect_arguments(const ViewsArguments& given) {
  CollectArguments arguments;
  arguments.out = given.out;
  MIXRIG_ASSIGN(arguments.settings.board, calibration::parse_board(given.board));
  MIXRIG_TRY(calibration::check_view_board(arguments.settings.board));
  arguments.settings.views = given.views, arguments.settings.frames = given.frames;
  arguments.settings.rest_px = given.rest_px;
  arguments.turn_views = given.turn_views;
  if (!given.turn.empty() && given.turn != "auto") {
    MIXRIG_ASSIGN(arguments.turn_deg, parse_size(given.turn, "--turn"));
  }
  return arguments;
}

Result<nlohmann::json> take_views(const ViewsArguments& given) {
  if (given.rig.empty() == given.take.empty())
    return Error{ErrorCode::kUsage,
                 "calibrate views: give one of --rig RIG.TOML (cameras now) and --take DIR (a "
                 "recording)"};
  MIXRIG_ASSIGN(const CollectArguments arguments, collect_arguments(given));
  MIXRIG_TRY(check_output_folder(given.out, "views.toml", given.force ? Force::kYes : Force::kNo));
  SystemClock clock;
  const StopOnSignal signals;
  if (!given.turn.empty()) {
    if (given.rig.empty())
      return Error{ErrorCode::kUsage, "--turn moves the unit of a rig: give --rig"};
    return turn_views(given.rig, arguments, StopOnSignal::flag(), clock);
  }
  MIXRIG_ASSIGN(const auto source, given.rig.empty()
                                       ? take::open_take_source(given.take)
                                       : open_cameras(given.rig, StopOnSignal::flag(), clock));
  return collect_views(*source, arguments, StopOnSignal::flag());
}

}  // namespace

void add_calibrate_views_command(Command app, Context& context) {
  auto arguments = std::make_shared<ViewsArguments>();
  Command group = app.group("calibrate", "calibrate cameras and rig");
  Command command = group.add_subcommand(
      "views", "stills of a board by all cameras, for calibrate rig, tof and ptu");
  command.add_option("OUT", arguments->out, "folder of views to write").required();
  command.add_option("--rig", arguments->rig,
                     "rig.toml: its cameras, now; Ctrl-C ends with what there is");
  add_take_option(command, arguments->take, "a recording of the board");
  command
      .add_option("--board", arguments->board,
                  "checkerboard:9x6:25mm (inner corners) or charuco:14x9:40mm:30mm:5X5_250 "
                  "(squares)")
      .required();
  command
      .add_option("--views", arguments->views,
                  "at least so many that target and depth camera share")
      .show_default()
      .range(3, 400);
  command
      .add_option("--frames", arguments->frames,
                  "frames in a row that must show the board at rest; a view is their mean")
      .show_default()
      .range(3, 64);
  command.add_option("--rest", arguments->rest_px, "motion of the board, px, that counts as rest")
      .show_default()
      .range(0.01, 10.0);
  command.add_option(
      "--turn", arguments->turn,
      "the board stands still and the pan-tilt unit of the rig turns: PANxTILT in "
      "degrees from side to side, or auto: as far as the board stays in the picture");
  command.add_option("--turn-views", arguments->turn_views, "--turn: angles at which it stops")
      .show_default()
      .range(5, 400);
  command.add_flag("--force", arguments->force, "replace the views that OUT holds");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return take_views(*arguments); }; });
}

}  // namespace mixrig::tools
