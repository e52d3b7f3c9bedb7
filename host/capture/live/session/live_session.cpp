// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/live_session.h"

#include <algorithm>
#include <cmath>

#include "hal/base/guarded.h"
#include "host/capture/capture/fisheye.h"

namespace mixrig::live {
namespace {

constexpr Duration kSessionWait = std::chrono::milliseconds(50);
constexpr Duration kStatusEvery = std::chrono::milliseconds(250);
constexpr Duration kTickPeriod = std::chrono::milliseconds(10);
constexpr Duration kAfterError = std::chrono::milliseconds(200);
// Frames of one moment lie at most this far apart where streams run free.
constexpr int kFarthestFree_ticks = 3;
constexpr double kMuchSlower = 1.5;
constexpr int kDoubts = 3;
constexpr Duration kFuture = std::chrono::milliseconds(20);
// Longest wait for an angle. Two queries of a head at 9600 baud take 70 ms. An axis that was
// queried just before the exposure is known after the next two: 140 ms, four frames at 25 Hz.
constexpr Duration kHeadPatience = std::chrono::milliseconds(155);

}  // namespace

LiveSession::LiveSession(const RigConfig& config, Devices& devices, Clock& clock)
    : config_(config), devices_(devices), clock_(clock), edges_(make_edges()) {
  for (std::size_t i = 0; i < devices.cameras.size(); ++i)
    add_stream(config.cameras[i], devices.cameras[i]->info());
  if (devices.depth) add_stream(*config.depth, devices.depth->info());
  if (devices.depth && devices.depth2) add_stream(*config.depth2, devices.depth2->info());
  std::vector<sync::Join> joins;
  for (const Stream& stream : streams_) joins.push_back(join_of(stream));
  builder_.emplace(joins, [this](const sync::FrameSet& set) { emit(set); });
}

/// A stream much slower than the leading one is not awaited: its last frame is used for the time of
/// capture::fisheye_hold().
sync::Join LiveSession::join_of(const Stream& stream) const {
  const double ticks = period_ticks(stream), leading_ticks = period_ticks(streams_.front());
  const double held_ticks = seconds(capture::fisheye_hold(100 / ticks)) / seconds(kTickPeriod);
  if (leading_ticks > 0 && ticks > kMuchSlower * leading_ticks)
    return {.farthest_ticks = static_cast<int>(std::ceil(held_ticks)), .awaited = false};
  const bool triggered = config_.line_of(*stream.config) != nullptr;
  return {.farthest_ticks =
              triggered ? std::max(1, static_cast<int>(ticks) / 2) : kFarthestFree_ticks};
}

/// Returns the ticks from frame to frame; 0 if unknown.
double LiveSession::period_ticks(const Stream& stream) const {
  if (const TriggerLine* line = config_.line_of(*stream.config)) return line->channel.divider;
  return stream.rate_hz > 0 ? 100 / stream.rate_hz : 0;
}

std::optional<sync::EdgeTicks> LiveSession::make_edges() const {
  const TriggerLine* line = config_.line(config_.edges_line);
  if (!devices_.edges || line == nullptr) return std::nullopt;
  const device::TriggerChannel& channel = line->channel;
  return sync::EdgeTicks({.divider = channel.divider,
                          .phase = static_cast<int>(channel.phase / kTickPeriod) % channel.divider,
                          .rest = channel.phase % kTickPeriod},
                         kTickPeriod, devices_.trigger != nullptr);
}

sync::StreamTiming LiveSession::timing_of(const CameraConfig& config) const {
  sync::StreamTiming timing{.divider = 0, .phase = 0, .delay = config.delay};
  const TriggerLine* line = config_.line_of(config);
  if (line == nullptr || !has_ticks()) return timing;
  const int divider = line->channel.divider;
  // Edges alone determine tick numbers only up to whole periods of their own line.
  if (!devices_.trigger && config_.line(config_.edges_line)->channel.divider % divider != 0)
    return timing;
  // Whole ticks of the phase shift the tick number; the remainder delays the exposure.
  timing.divider = divider;
  timing.phase = static_cast<int>(line->channel.phase / kTickPeriod) % divider;
  timing.delay += line->channel.phase % kTickPeriod;
  return timing;
}

void LiveSession::add_stream(const CameraConfig& config, const device::CameraInfo& info) {
  streams_.emplace_back();
  streams_.back().config = &config;
  streams_.back().stamp_clock = info.stamp_clock;
  streams_.back().rate_hz = info.rate_hz > 0 ? info.rate_hz : config.request.rate_hz;
  const sync::StreamTiming timing = timing_of(config);
  streams_.back().fired = timing.divider > 0;
  streams_.back().pairer = sync::FramePairer(timing);
}

Result<void> LiveSession::start() {
  if (running_) return Error{ErrorCode::kUsage, "the session is already running"};
  stop_ = false;
  events_.open();
  sets_.open();
  for (Stream& stream : streams_) stream.pairer.restart();  // counters may start again
  running_ = true;
  const auto failed = [this](const Error& error) { fail(error); };
  sync_thread_ = guarded_thread(
      "pairing of frames", [this] { run_sync(); }, failed);
  // Cameras first: a camera that waits for a trigger must not miss the first one.
  auto started = start_cameras();
  const auto on_edge = [this](const device::LineEdge& edge) {
    push({.kind = Event::Kind::kEdge, .tick = {0, edge.at}, .stream = 0, .frame = {}});
  };
  if (started && edges_) started = devices_.edges->start(on_edge);
  if (started && devices_.trigger) started = start_trigger();
  if (!started) {
    stop();
    return started;
  }
  if (devices_.trigger)
    trigger_thread_ = guarded_thread(
        "trigger", [this] { run_trigger(); }, failed);
  if (devices_.pan_tilt)
    pan_tilt_thread_ = guarded_thread(
        "pan-tilt unit", [this] { run_pan_tilt(); }, failed);
  return {};
}

/// Called by the thread that ends. A command to the head that waits is answered.
void LiveSession::fail(const Error& error) {
  const std::lock_guard lock(mutex_);
  if (!fault_) fault_ = error;
  head_command_.reset();
  head_answer_ = error;
  head_answered_.notify_all();
}

void LiveSession::push(Event event) {
  ++pushed_;
  events_.push(std::move(event));
}

Result<void> LiveSession::start_cameras() {
  const auto sink = [this](std::size_t stream) {
    return [this, stream](const device::FramePtr& frame) {
      push({.kind = Event::Kind::kFrame, .tick = {}, .stream = stream, .frame = frame});
    };
  };
  for (std::size_t i = 0; i < devices_.cameras.size(); ++i)
    MIXRIG_TRY(devices_.cameras[i]->start(sink(i)));
  if (devices_.depth) MIXRIG_TRY(devices_.depth->start(sink(devices_.cameras.size())));
  if (devices_.depth && devices_.depth2)
    MIXRIG_TRY(devices_.depth2->start(sink(devices_.cameras.size() + 1)));
  return {};
}

Result<void> LiveSession::start_trigger() {
  MIXRIG_ASSIGN(const device::TriggerStatus status, devices_.trigger->status());
  if (status.state != device::TriggerState::kIdle) MIXRIG_TRY(devices_.trigger->stop());
  for (const TriggerLine& line : config_.lines)
    MIXRIG_TRY(devices_.trigger->configure(line.line, line.channel));
  return devices_.trigger->start();
}

void LiveSession::stop() {
  if (!running_) return;
  for (auto& camera : devices_.cameras) camera->stop();
  if (devices_.depth) devices_.depth->stop();
  if (devices_.depth2) devices_.depth2->stop();
  if (devices_.edges) devices_.edges->stop();
  stop_ = true;
  events_.close();
  for (std::thread* thread : {&trigger_thread_, &pan_tilt_thread_, &sync_thread_})
    if (thread->joinable()) thread->join();
  if (devices_.trigger) (void)devices_.trigger->stop();
  sets_.close();
  running_ = false;
}

void LiveSession::run_trigger() {
  HostTime next_status = clock_.now();
  while (!stop_) {
    if (follow_trigger(next_status)) continue;
    {
      const std::lock_guard lock(mutex_);
      ++counts_.trigger_errors;
    }
    clock_.sleep_until(clock_.now() + kAfterError);
  }
}

/// Reads the master's clock, its state and its ticks. False after an error.
bool LiveSession::follow_trigger(HostTime& next_status) {
  if (clock_.now() >= next_status) {
    next_status = clock_.now() + kStatusEvery;
    const auto status = devices_.trigger->status();
    if (!status) return false;
    if (status->state != device::TriggerState::kRunning) {
      // The master was reset. Its tick numbers and its clock restart: frames that it triggers from
      // now on must not be paired with an old tick, and its time is read before its ticks.
      push({.kind = Event::Kind::kTickRestart, .tick = {}, .stream = 0, .frame = {}});
      if (!start_trigger()) return false;
      next_status = clock_.now();
      const std::lock_guard lock(mutex_);
      trigger_clock_ = {};
      ++counts_.trigger_restarts;
      return true;
    }
    const std::lock_guard lock(mutex_);
    (void)trigger_clock_.add(status->now, status->asked, status->answered);
  }
  std::array<device::TriggerTick, 16> ticks;
  const auto count = devices_.trigger->read_ticks(ticks, kSessionWait);
  if (!count) return false;
  for (std::size_t i = 0; i < *count; ++i) {
    std::optional<HostTime> at;
    {
      const std::lock_guard lock(mutex_);
      at = trigger_clock_.to_host(ticks[i].at);
    }
    if (at)
      push({.kind = Event::Kind::kTick, .tick = {ticks[i].tick, *at}, .stream = 0, .frame = {}});
  }
  return true;
}

void LiveSession::run_pan_tilt() {
  while (!stop_) {
    obey_head_command();
    const auto sample = devices_.pan_tilt->sample();
    const auto health = devices_.pan_tilt->health();
    {
      const std::lock_guard lock(mutex_);
      counts_.pan_tilt = health;
      if (sample) {
        track_.add(*sample);
        ++counts_.pan_tilt_samples;
        release(kHeadPatience, kHeld);
        continue;
      }
      ++counts_.pan_tilt_errors;
    }
    clock_.sleep_until(clock_.now() + kAfterError);
  }
}

void LiveSession::run_sync() {
  while (!stop_) {
    const auto event = events_.pop(kSessionWait);
    const std::lock_guard lock(mutex_);
    if (event) {
      on_event(*event);
      ++handled_;
    }
    release(kHeadPatience, kHeld);
  }
  const std::lock_guard lock(mutex_);
  builder_->flush();
  release({}, 0);
}

void LiveSession::on_event(const Event& event) {
  switch (event.kind) {
    case Event::Kind::kTick:
      on_tick(event.tick);
      break;
    case Event::Kind::kTickRestart:
      on_restart();
      if (edges_) edges_->restart();
      break;
    case Event::Kind::kEdge:
      on_edge(event.tick.at);
      break;
    case Event::Kind::kFrame:
      on_frame(event);
      break;
    case Event::Kind::kNone:
      break;
  }
}

void LiveSession::on_tick(const sync::Tick& tick) {
  ++counts_.ticks;
  if (edges_) edges_->on_master_tick(tick);
  // The tick's message was late; an edge already replaced it.
  if (newest_from_edge_ && ticks_.newest() && tick.sequence <= *ticks_.newest()) return;
  newest_from_edge_ = false;
  ticks_.add(tick);
}

void LiveSession::on_edge(HostTime at) {
  const auto made = edges_->add(at);
  if (!made) return;
  if (made->restarted) on_restart();
  newest_from_edge_ = true;
  ticks_.add(made->tick);
}

/// Handles a restart of tick numbers.
void LiveSession::on_restart() {
  for (Stream& stream : streams_) stream.pairer.restart();
  builder_->restart();
  ticks_.clear();
  newest_from_edge_ = false;
}

void LiveSession::on_frame(const Event& event) {
  Stream& stream = streams_[event.stream];
  const device::Frame& frame = *event.frame;
  if ((frame.flags & device::kFrameRestarted) != 0) stream.pairer.restart();
  const HostTime stamp = stamp_of(stream, frame);
  if (!has_ticks()) {
    // There is no master: the host's clock divided by ten milliseconds gives tick numbers.
    const auto number = static_cast<std::uint64_t>(stamp.time_since_epoch() / kTickPeriod);
    const sync::Tick tick{number, HostTime(static_cast<long>(number) * kTickPeriod)};
    if (const auto newest = ticks_.newest(); !newest || *newest < number) ticks_.add(tick);
  }
  if (ticks_.empty()) return;  // the stream starts before the master's first tick
  const sync::Pairing pairing = stream.pairer.pair(ticks_, frame.sequence, stamp, frame.received);
  count_clock_doubt(stream, pairing.clock_doubted);
  if (!pairing.usable() || (frame.flags & device::kFrameIncomplete) != 0) return;
  ++stream.paired;
  stream.residual_sum_s += seconds(pairing.residual);
  stream.residual_square_s2 += seconds(pairing.residual) * seconds(pairing.residual);
  // The tick of a triggered stream is more accurate than the stamp; else only the stamp is known.
  const auto tick_time = stream.fired ? ticks_.time_of(pairing.tick) : std::nullopt;
  builder_->add(event.stream,
                {event.frame, pairing, tick_time ? *tick_time + stream.config->delay : stamp});
}

/// Counts stamps that contradict counter and arrival. After kDoubts in a row the camera's clock was
/// set, and its map restarts.
void LiveSession::count_clock_doubt(Stream& stream, bool doubted) {
  stream.doubts = doubted ? stream.doubts + 1 : 0;
  if (stream.doubts < kDoubts) return;
  stream.doubts = 0;
  stream.clock = {};
}

HostTime LiveSession::stamp_of(Stream& stream, const device::Frame& frame) {
  switch (stream.stamp_clock) {
    case device::StampClock::kHost:
      return HostTime(frame.device_time.time_since_epoch());
    case device::StampClock::kDevice: {
      (void)stream.clock.add(frame.device_time, frame.received);
      const HostTime at = stream.clock.to_host(frame.device_time).value_or(frame.received);
      if (at <= frame.received + kFuture) return at;
      stream.clock = {};  // a stamp after the arrival: the camera's clock was set ahead
      return frame.received;
    }
    case device::StampClock::kNone:
      break;
  }
  return frame.received;
}

/// Hands a set out. With a head, sets are handed out in bursts, so one more may wait.
void LiveSession::emit(const sync::FrameSet& set) {
  sets_.trim(devices_.pan_tilt ? kSets : kSets - 1);
  release(kHeadPatience, kHeld - 1);
  (void)held_.push({set, {}});
  release(kHeadPatience, kHeld);
}

/// Hands out the sets whose angle is known, those that waited for it long enough, and all but the
/// newest `most`. The lock is held.
void LiveSession::release(Duration patience, std::size_t most) {
  while (!held_.empty()) {
    LiveSet& set = held_.front();
    const HostTime at = set.frames.frames[0].mid_exposure;
    set.pan_tilt = track_.at(at);
    const bool missing = devices_.pan_tilt && !set.pan_tilt;
    if (missing && held_.size() <= most && clock_.now() < at + patience) break;
    if (missing) ++counts_.sets_without_angle;
    sets_.push(held_.pop());
  }
  held_count_ = held_.size();
}

}  // namespace mixrig::live
