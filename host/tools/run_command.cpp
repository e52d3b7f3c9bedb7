// SPDX-License-Identifier: Apache-2.0
// mixrig run: composites a scene into a take.
#include <cmath>
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "host/operator/desk/place_sink.h"
#include "host/output/viewfinder/viewfinder.h"
#include "host/run/loop/run.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"
#include "host/tools/learn_on_signal.h"
#include "host/tools/options.h"
#include "host/tools/run_page.h"
#include "host/tools/service_sink.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

constexpr double kMinute_s = 60;

struct RunArguments {
  SessionArguments session;
  PageArguments page;
  std::string out, frames, format = "png", view, stream, focus;
  bool layers = false, inspect = false, baselines = false;
  bool watch = false, no_watch = false, accept_changes = false, follow_scene = false;
  std::string save_room;
  double segment_minutes = 0;
  double change_after_s = model::WatchOptions{}.appeared_s;
};

using viewfinder::ViewfinderReport;

/// "X,Y" of the view.
Result<glm::ivec2> parse_focus(const std::string& text, const session::Session& session) {
  int x = 0, y = 0;
  char rest = 0;
  const Size view = session.setup.view.size_px;
  if (!session.setup.focus)
    return Error{ErrorCode::kUsage,
                 "--focus: the scene has no [focus]: add it, with the aperture of the lens"};
  if (std::sscanf(text.c_str(), "%d,%d%c", &x, &y, &rest) == 2 && x >= 0 && y >= 0 &&
      x < view.width && y < view.height)
    return glm::ivec2(x, y);
  return Error{ErrorCode::kUsage,
               "--focus \"" + text + "\" is no pixel X,Y of the view of " + session::text(view)};
}

/// Adds the window of --view as a sink, and the sink that places objects where it is clicked.
Result<void> open_view(const RunArguments& arguments, session::Session& session, const Clock& clock,
                       ViewfinderReport& report, session::RunParts& parts) {
  if (arguments.view.empty()) return {};
  const viewfinder::ViewfinderOptions view{
      .title = "mixrig: " + session.scene.path.filename().string(),
      .view = output::view_named(arguments.view).value_or(output::View::kComposite),
      .picture_px = session.setup.view.size_px,
      .shares = session.backend.backend != render::Backend::kCpu};
  MIXRIG_ASSIGN(auto sink, viewfinder::Viewfinder::create(view, *session.source, *parts.orders,
                                                          clock, report));
  // Not before the window is open: the look for a GPU opens the display's device, which a window
  // without a desktop needs for itself.
  if (session::takes_gles(session.backend))
    session.backend.share = sink->share();
  else
    sink->forget_share();
  if (!parts.scene && session.source->info().is_live())
    parts.scene = std::make_shared<session::SceneFollower>(session, true);
  if (parts.scene)
    parts.sinks.push_back(
        std::make_unique<session::PlaceSink>(session, parts.scene, *parts.orders));
  parts.sinks.push_back(std::move(sink));
  return {};
}

nlohmann::json to_json(const ViewfinderReport& report) {
  nlohmann::json out{
      {"driver", report.driver}, {"shown", report.shown}, {"replaced", report.replaced}};
  const auto times = [&](const char* key, const measure::QuantileSketch& ms) {
    if (ms.count() == 0) return;
    const auto at = [&](double q) { return std::round(10 * ms.quantile(q)) / 10; };
    out[key] = {{"p50", at(0.5)}, {"p95", at(0.95)}, {"p99", at(0.99)}};
  };
  times("show_ms", report.show_ms);
  times("delay_ms", report.delay_ms);
  return out;
}

/// Options of a run, except the pixel of --focus, for which the view must be known.
Result<session::RunOptions> parse_options(const RunArguments& arguments, const Clock& clock) {
  session::RunOptions options;
  if (!arguments.out.empty()) options.out = arguments.out;
  options.output.format = arguments.format == "video"  ? output::OutputFormat::kVideo
                          : arguments.format == "none" ? output::OutputFormat::kNone
                                                       : output::OutputFormat::kPng;
  options.output.layers = arguments.layers;
  options.output.inspect = arguments.inspect;
  options.output.segment_s = kMinute_s * arguments.segment_minutes;
  options.baselines = arguments.baselines;
  options.judge = !arguments.page.serves;
  if (!arguments.stream.empty()) options.streams.emplace_back().uri = arguments.stream;
  if (!arguments.frames.empty()) {
    MIXRIG_ASSIGN(options.frames, parse_range(arguments.frames, "--frames"));
  }
  const bool watches = arguments.watch || arguments.accept_changes || !arguments.save_room.empty();
  if (arguments.no_watch && watches)
    return Error{ErrorCode::kUsage,
                 "--no-watch excludes --watch, --accept-changes and --save-room: drop one"};
  if (arguments.no_watch || watches) options.watch_room = watches;
  options.changes.watch = model::watch_options(arguments.change_after_s);
  options.changes.accept_all = arguments.accept_changes;
  if (!arguments.save_room.empty()) options.save_room = arguments.save_room;
  if (arguments.page.takes_osc && !arguments.page.serves)
    return Error{ErrorCode::kUsage, "--osc-in needs --page: add it"};
  if (!arguments.page.proxied.empty() && !arguments.page.serves)
    return Error{ErrorCode::kUsage, "--page-proxy needs --page: add it"};
  if (!arguments.page.token_file.empty() && !arguments.page.serves)
    return Error{ErrorCode::kUsage, "--page-token needs --page: add it"};
  options.epoch = [&clock] {
    return Duration(std::chrono::system_clock::now().time_since_epoch()).count() -
           clock.now().time_since_epoch().count();
  };
  return options;
}

/// What a run has written: its folder, else the video that it was streamed into.
std::string written(const RunArguments& arguments) {
  const bool is_file = arguments.stream.find("://") == std::string::npos;
  return arguments.out.empty() && is_file ? arguments.stream : arguments.out;
}

/// What to look at after a run.
std::string next_after(const RunArguments& arguments) {
  if (!arguments.out.empty()) return "look at " + arguments.out + "/contact_sheet.png";
  if (arguments.page.serves || !arguments.view.empty() || !arguments.stream.empty()) return {};
  return "give --out FOLDER to keep the composite, or --page to watch it";
}

Result<nlohmann::json> run(const RunArguments& arguments) {
  MIXRIG_ASSIGN(session::SessionOptions session_arguments, session_options(arguments.session));
  SystemClock clock;
  MIXRIG_ASSIGN(session::RunOptions options, parse_options(arguments, clock));
  const StopOnSignal signals;
  output::RunOrders orders(StopOnSignal::flag());
  const LearnOnSignal learn_signal(orders);
  session_arguments.clock = &clock, session_arguments.stop = &orders.stop();
  MIXRIG_ASSIGN(const auto session, opened_session(session_arguments));
  MIXRIG_TRY(check_extras(session->scene));
  session::RunParts parts;
  parts.extras = run_extras(), parts.orders = &orders, parts.stop = &orders.stop();
  PageRun page;
  if (arguments.page.serves) {
    MIXRIG_ASSIGN(page, open_page(arguments.page, *session, clock, parts));
  }
  if (arguments.follow_scene && !arguments.page.serves)
    parts.scene = std::make_shared<session::SceneFollower>(*session, false);
  if (!arguments.focus.empty()) {
    MIXRIG_ASSIGN(options.focus_px, parse_focus(arguments.focus, *session));
  }
  ViewfinderReport shown;
  MIXRIG_TRY(open_view(arguments, *session, clock, shown, parts));
  if (auto service = make_service_sink(clock)) parts.sinks.push_back(std::move(service));
  MIXRIG_ASSIGN(const session::RunReport report,
                session::run(*session, options, clock,
                             progress_bar(session->source->info().is_live()), std::move(parts)));
  std::fputs(session::to_table(report).c_str(), stdout);
  nlohmann::json json = session::to_json(report);
  if (!arguments.view.empty()) json["viewfinder"] = to_json(shown);
  print_notes(session->scene, json);
  return with_end(std::move(json), written(arguments), next_after(arguments));
}

}  // namespace

void add_run_command(Command app, Context& context) {
  auto arguments = std::make_shared<RunArguments>();
  Command command = app.add_subcommand(
      "run", "composite a scene into a take; write pictures, contact sheet and report");
  add_session_options(command, arguments->session);
  command.add_option("--out", arguments->out,
                     "folder to write, new or made by an earlier run; no files if not given");
  command.add_option("--frames", arguments->frames,
                     "FIRST-LAST to composite; all after the learned ones if not given");
  command
      .add_option("--format", arguments->format,
                  "of composite and mixed depth: png, video (Matroska, lossless) or none")
      .one_of({"png", "video", "none"});
  command
      .add_option("--view", arguments->view,
                  "show it while it happens, in a window or on a board's whole screen: composite, "
                  "plate, key, depth, light or matte; keys change it, H lists them")
      .value_if_left_out("composite")
      .one_of({"composite", "plate", "key", "depth", "light", "matte"});
  command.add_option(
      "--stream", arguments->stream,
      "where the composite is sent: srt://HOST:PORT, rtp://HOST:PORT, shm://PATH, "
      "v4l2://DEVICE, or a file .mkv, .mov or .mp4; more by [[stream_out]] of the scene");
  command.add_option("--focus", arguments->focus,
                     "X,Y of the view: what is seen there is sharp, in place of the distance in "
                     "[focus] of the scene; a click in the window of --view chooses another pixel");
  command.add_flag("--layers", arguments->layers, "write segmented depth and matte as well");
  command.add_flag("--inspect", arguments->inspect,
                   "write warped depth, key and light map as well");
  command.add_flag("--baselines", arguments->baselines,
                   "judge plain composites beside it: the plate, the objects pasted on top, a "
                   "plain depth key; and what one without error would make (a take with truth)");
  command.add_flag("--accept-changes", arguments->accept_changes,
                   "take what changed in the room into the background as soon as it is certain; "
                   "else on the signal USR1: kill -USR1 PID");
  command.add_option("--save-room", arguments->save_room,
                     "folder to write at the end: the background with what was accepted");
  command
      .add_option("--change-after", arguments->change_after_s,
                  "seconds for which a thing must have stood still to be one, 1 to 600; what is "
                  "gone two thirds of it, a colour five thirds")
      .range(1.0, 600.0)
      .show_default();
  command.add_flag("--watch", arguments->watch,
                   "look for changes of the room in a recording, too; live runs do");
  command.add_flag("--follow-scene", arguments->follow_scene,
                   "composite what is saved to SCENE meanwhile, of a recording, too; live runs do");
  command.add_flag("--no-watch", arguments->no_watch, "do not look for changes of the room");
  command
      .add_option("--segment-minutes", arguments->segment_minutes,
                  "minutes of a take of composites; then the next one follows; 0: one take")
      .show_default()
      .range(0.0, 1440.0);
  add_page_options(command, arguments->page);
  command.callback([&context, arguments, command] {
    arguments->page.serves = command.count("--page") > 0;
    arguments->page.segment_s = kMinute_s * arguments->segment_minutes;
    arguments->page.takes_osc = command.count("--osc-in") > 0;
    context.action = [arguments] { return run(*arguments); };
  });
}

}  // namespace mixrig::tools
