// SPDX-License-Identifier: Apache-2.0
#include "host/session/operator_desk.h"

#include <utility>

#include <fmt/format.h>

#include "hal/base/recent_log.h"
#include "host/session/change_sink.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;

class DeskSink final : public output::CompositeSink {
 public:
  explicit DeskSink(OperatorDesk& desk) : desk_(desk) {}
  std::string_view name() const override { return "operator"; }
  render::OutputMask wanted(int /*number*/) const override { return desk_.wanted(); }
  Result<void> write(const output::CompositePtr& composite) override {
    desk_.see(composite);
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  OperatorDesk& desk_;
};

page::StreamState stream_state(const capture::StreamReport& report) {
  const device::StreamHealth& health = report.health;
  page::StreamState state;
  state.name = report.name, state.uri = report.uri;
  state.frames = health.frames;
  state.lost = health.lost + health.overrun + report.pairing.missing;
  state.ok = health.state == device::DeviceState::kStreaming;
  if (!state.ok)
    state.what_to_do = "delivers nothing: check cable and power; mixrig diag says more";
  return state;
}

/// Of the first folder above it that is there.
std::optional<double> free_gb(fs::path folder) {
  std::error_code code;
  folder = fs::absolute(folder, code);
  while (!fs::exists(folder, code) && folder.has_relative_path()) folder = folder.parent_path();
  const fs::space_info space = fs::space(folder, code);
  if (code) return std::nullopt;
  return static_cast<double>(space.available) / 1e9;
}

}  // namespace

OperatorDesk::OperatorDesk(const Session& session, std::shared_ptr<SceneFollower> follower,
                           const Clock& clock, DeskOptions options)
    : session_(session),
      clock_(clock),
      options_(std::move(options)),
      scene_(session, std::move(follower)),
      recorder_(session, options_.takes) {}

std::unique_ptr<output::CompositeSink> OperatorDesk::make_sink() {
  return std::make_unique<DeskSink>(*this);
}

render::OutputMask OperatorDesk::wanted() const {
  return render::kMatte | (recorder_.is_on() ? render::kColor | render::kMixedDepth : 0);
}

void OperatorDesk::see(const output::CompositePtr& composite) {
  recorder_.write(composite);
  const bool can_learn = options_.requests != nullptr && ChangeSink::can_watch(session_);
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
  f.background_possible = can_learn;
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

page::CalibrationState OperatorDesk::calibration() const {
  using calibration_file::CalibrationOrigin;
  const calibration_file::CalibrationChoice& choice = session_.calibration;
  page::CalibrationState state;
  state.file = choice.where, state.why = choice.why;
  std::error_code code;
  const auto written = fs::last_write_time(choice.file, code);
  if (!code && !choice.file.empty())
    state.age_s = std::chrono::duration<double>(fs::file_time_type::clock::now() - written).count();
  const bool guessed = choice.origin == CalibrationOrigin::kGuess;
  state.verdict = guessed ? page::Verdict::kNoGo : page::Verdict::kGo;
  state.reason = guessed ? "the cameras are guessed: run mixrig calibrate, or name a calibration"
                         : "the cameras are known";
  return state;
}

std::vector<page::StreamState> OperatorDesk::streams() const {
  std::vector<page::StreamState> states;
  const auto report = session_.source->report();
  if (!report) {
    page::StreamState& played = states.emplace_back();
    played.name = session_.source->info().name, played.uri = "recording";
    return states;
  }
  for (const capture::StreamReport& stream : report->streams)
    states.push_back(stream_state(stream));
  return states;
}

page::State OperatorDesk::state() const {
  const Frames f = frames();
  const SeenFrom* from = f.from ? &*f.from : nullptr;
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
  state.background_possible = f.background_possible;
  state.background = f.background_possible
                         ? "what changed in the room and stands still can become background"
                         : "the background of this run is not watched";
  state.disk_free_gb = free_gb(recorder_.folder());
  state.calibration = calibration();
  state.streams = streams();
  state.objects = scene_.objects(from), state.lamps = scene_.lamps(from);
  state.log = recent_log_lines();
  return state;
}

Result<void> OperatorDesk::learn_background() {
  if (!frames().background_possible)
    return Error{ErrorCode::kUnsupported,
                 "the background of this run is not watched: its camera or lens moves without a "
                 "scanned room, or it was started with --no-watch"};
  ++*options_.requests;
  return {};
}

Result<void> OperatorDesk::apply(const page::Command& command) {
  const Frames f = frames();
  const SeenFrom* from = f.from ? &*f.from : nullptr;
  return std::visit(
      [&](const auto& c) -> Result<void> {
        using C = std::decay_t<decltype(c)>;
        if constexpr (std::is_same_v<C, page::StartRecording>)
          return recorder_.start(c.name, c.notes);
        else if constexpr (std::is_same_v<C, page::StopRecording>)
          return recorder_.stop();
        else if constexpr (std::is_same_v<C, page::LearnBackground>)
          return learn_background();
        else if constexpr (std::is_same_v<C, page::SaveScene>)
          return scene_.save();
        else if constexpr (requires { scene_.apply(c, from); })
          return scene_.apply(c, from);
        else
          return scene_.apply(c);
      },
      command);
}

}  // namespace mixrig::session
