// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/operator_desk.h"

#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "hal/base/recent_log.h"
#include "host/operator/desk/desk_state.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

class DeskSink final : public output::CompositeSink {
 public:
  explicit DeskSink(OperatorDesk& desk) : desk_(desk) {}
  std::string_view name() const override { return "operator"; }
  bool is_quick() const override { return true; }
  render::OutputMask wanted(int /*number*/) const override { return desk_.wanted(); }
  Result<void> write(const output::CompositePtr& composite) override {
    desk_.see(composite);
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  OperatorDesk& desk_;
};

}  // namespace

OperatorDesk::OperatorDesk(const Session& session, std::shared_ptr<SceneFollower> follower,
                           output::RunOrders& orders, Clock& clock, DeskOptions options)
    : session_(session),
      orders_(orders),
      clock_(clock),
      options_(std::move(options)),
      scene_(session, std::move(follower)),
      cameras_(session, scene_.history()),
      presets_(session, scene_),
      takes_(options_.takes),
      recorder_(session, options_.takes, free_gb, options_.segment_s),
      sweep_(session, scene_, clock) {
  orders_.tell([](output::RunState& run) { run.records_takes = true, run.recording = false; });
}

std::unique_ptr<output::CompositeSink> OperatorDesk::make_sink() {
  return std::make_unique<DeskSink>(*this);
}

render::OutputMask OperatorDesk::wanted() const {
  return render::kMatte | (recorder_.is_on() ? render::kColor | render::kMixedDepth : 0);
}

void OperatorDesk::see(const output::CompositePtr& composite) {
  obey_record_orders();
  recorder_.write(composite);
  const HostTime now = clock_.now();
  const std::lock_guard lock(mutex_);
  Frames& f = frames_;
  ++f.count, ++f.second_count;
  f.number = composite->capture->number;
  f.frame_ms = static_cast<double>(composite->frame_ms);
  f.delay_ms = milliseconds(now - composite->capture->mid_exposure);
  f.finished = now;
  f.pose = composite->pose.ok() ? "ok" : std::string(capture::name(composite->pose.loss));
  f.objects_shown = composite->objects_shown;
  f.from = SeenFrom{composite->world_from_target, composite->view};
  const double elapsed_s = seconds(now - f.second_began);
  if (f.count > 1 && elapsed_s < 1) return;
  if (f.count > 1) f.fps = static_cast<double>(f.second_count) / elapsed_s;
  f.second_began = now, f.second_count = 0;
}

OperatorDesk::Frames OperatorDesk::frames() const {
  const std::lock_guard lock(mutex_);
  return frames_;
}

page::State OperatorDesk::state() const {
  const Frames f = frames();
  const SeenFrom* from = f.from ? &*f.from : nullptr;
  const output::RunState run = orders_.state();
  page::State state;
  state.scene = session_.scene.path.string();
  state.source = session_.source->info().name;
  state.live = options_.live;
  state.width = session_.setup.view.size_px.width;
  state.height = session_.setup.view.size_px.height;
  state.frames = f.count, state.frame = f.number;
  state.fps = f.fps, state.frame_ms = f.frame_ms, state.delay_ms = f.delay_ms;
  if (f.count > 0) state.since_frame_s = seconds(clock_.now() - f.finished);
  state.pose = f.pose, state.objects_shown = f.objects_shown;
  state.recording = recorder_.state();
  state.background_possible = run.can_learn;
  state.background = state.background_possible
                         ? "changes of the room that stand still can be accepted as background"
                         : "this run does not look for changes of the room";
  state.scan = scan_state(run);
  state.disk_free_gb = free_gb(recorder_.folder());
  state.record_minutes = takes_.minutes_left(state.recording, state.disk_free_gb);
  state.takes = takes_.takes(state.recording), state.presets = presets_.presets();
  state.calibration = calibration_of(session_, cameras_.zoomed(), cameras_.focused());
  state.streams = streams_of(session_), state.cameras = cameras_of(session_);
  state.sweep = sweep_.state();
  state.focus = focus_of(scene_.focus(), run.focus_px, session_.setup.view.size_px);
  state.objects = scene_.objects(from), state.lamps = scene_.lamps(from);
  state.edits = {scene_.history().next_undo(), scene_.history().next_redo()};
  state.log = recent_log_lines();
  return state;
}

Result<void> OperatorDesk::learn_background() {
  if (!orders_.state().can_learn)
    return Error{
        ErrorCode::kUnsupported,
        "this run does not look for changes of the room: its camera or lens moves without a "
        "scanned room, or it was started with --no-watch"};
  return orders_.give(output::LearnChanges{});
}

page::ScanState OperatorDesk::scan_state(const output::RunState& run) {
  page::ScanState state;
  state.possible = run.can_scan;
  state.total = run.scan_left > 0 ? output::kScanLooks : 0;
  state.done = state.total - run.scan_left;
  if (!state.possible)
    state.why_not =
        "the empty room can be learned here only for a camera that stands still: where it "
        "moves, end the run and use mixrig scan";
  return state;
}

Result<void> OperatorDesk::scan_room(bool on) {
  const page::ScanState now = scan_state(orders_.state());
  if (!now.possible) return Error{ErrorCode::kUnsupported, now.why_not};
  if (!on && now.total == 0) return Error{ErrorCode::kData, "the room is not being learned"};
  return orders_.give(output::LearnRoom{on});
}

/// Begins a recording, or ends it where `start` is null.
Result<void> OperatorDesk::record(const page::StartRecording* start) {
  const std::lock_guard lock(record_mutex_);
  auto done = start != nullptr ? recorder_.start(start->name, start->notes) : recorder_.stop();
  tell_recording();
  return done;
}

/// Follows record orders given by keys; also reports an error that has ended a recording.
void OperatorDesk::obey_record_orders() {
  const std::unique_lock lock(record_mutex_, std::try_to_lock);
  if (!lock) return;  // one begins or ends now
  while (const auto order = orders_.take<output::Record>()) {
    if (order->on == recorder_.is_on()) continue;
    const auto done = order->on ? recorder_.start("", "") : recorder_.stop();
    if (!done) log_warning("session", "recording: " + to_line(done.error()));
  }
  tell_recording();
}

void OperatorDesk::tell_recording() {
  orders_.tell([on = recorder_.is_on()](output::RunState& run) { run.recording = on; });
}

/// Writes previews into the scene, and the focus that was clicked in a window of the run.
Result<void> OperatorDesk::save() {
  MIXRIG_TRY(scene_.save());
  const output::RunState run = orders_.state();
  if (!run.focus_px || !run.can_focus) return {};
  return scene_.apply(
      page::SetFocus{.at = focus_of(scene_.focus(), run.focus_px, session_.setup.view.size_px).at});
}

Result<void> OperatorDesk::discard() {
  MIXRIG_TRY(scene_.discard());
  return cameras_.discard();
}

Result<void> OperatorDesk::apply(const page::Command& command) {
  const Frames f = frames();
  const SeenFrom* from = f.from ? &*f.from : nullptr;
  return std::visit(
      [&](const auto& c) -> Result<void> {
        using C = std::decay_t<decltype(c)>;
        if constexpr (std::is_same_v<C, page::StartRecording>)
          return record(&c);
        else if constexpr (std::is_same_v<C, page::StopRecording>)
          return record(nullptr);
        else if constexpr (std::is_same_v<C, page::SetCamera>)
          return cameras_.apply(c);
        else if constexpr (std::is_same_v<C, page::LearnBackground>)
          return learn_background();
        else if constexpr (std::is_same_v<C, page::ScanRoom>)
          return scan_room(c.on);
        else if constexpr (std::is_same_v<C, page::StartSweep>)
          return sweep_.start(c);
        else if constexpr (std::is_same_v<C, page::CancelSweep>)
          return sweep_.cancel();
        else if constexpr (std::is_same_v<C, page::SaveScene>)
          return save();
        else if constexpr (std::is_same_v<C, page::DiscardPreviews>)
          return discard();
        else if constexpr (std::is_same_v<C, page::Undo>)
          return c.again ? scene_.redo() : scene_.undo();
        else if constexpr (std::is_same_v<C, page::SetTake>)
          return takes_.apply(c);
        else if constexpr (requires { presets_.apply(c); })
          return presets_.apply(c);
        else if constexpr (requires { scene_.apply(c, from); })
          return scene_.apply(c, from);
        else
          return scene_.apply(c);
      },
      command);
}

}  // namespace mixrig::session
