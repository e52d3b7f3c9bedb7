// SPDX-License-Identifier: Apache-2.0
#include "host/rig/live_session.h"

#include <algorithm>
#include <cmath>

namespace mixrig::rig {
namespace {

constexpr Duration kWait = std::chrono::milliseconds(50);
constexpr Duration kStatusEvery = std::chrono::milliseconds(250);
constexpr Duration kTickPeriod = std::chrono::milliseconds(10);
constexpr Duration kAfterError = std::chrono::milliseconds(200);
// Frames of one moment lie at most this far apart where streams run free.
constexpr int kFarthestFree_ticks = 3;
constexpr double kMuchSlower = 1.5;
constexpr int kDoubts = 3;
constexpr Duration kFuture = std::chrono::milliseconds(20);

}  // namespace

LiveSession::LiveSession(const RigConfig& config, Devices& devices, Clock& clock)
    : config_(config), devices_(devices), clock_(clock) {
  for (std::size_t i = 0; i < devices.cameras.size(); ++i)
    add_stream(config.cameras[i], devices.cameras[i]->info());
  if (devices.depth) add_stream(*config.depth, devices.depth->info());
  std::vector<sync::Join> joins;
  for (const Stream& stream : streams_) joins.push_back(join_of(stream));
  builder_.emplace(joins, [this](const sync::FrameSet& set) { emit(set); });
}

/// A stream much slower than the leading one is not awaited: its last frame is at hand.
sync::Join LiveSession::join_of(const Stream& stream) const {
  const double ticks = period_ticks(stream), leading_ticks = period_ticks(streams_.front());
  if (leading_ticks > 0 && ticks > kMuchSlower * leading_ticks)
    return {.farthest_ticks = static_cast<int>(std::ceil(ticks)), .awaited = false};
  const bool triggered = config_.line_of(*stream.config) != nullptr;
  return {.farthest_ticks =
              triggered ? std::max(1, static_cast<int>(ticks) / 2) : kFarthestFree_ticks};
}

/// Ticks from frame to frame; 0 where nobody tells.
double LiveSession::period_ticks(const Stream& stream) const {
  if (const TriggerLine* line = config_.line_of(*stream.config)) return line->channel.divider;
  return stream.rate_hz > 0 ? 100 / stream.rate_hz : 0;
}

void LiveSession::add_stream(const CameraConfig& config, const device::CameraInfo& info) {
  sync::StreamTiming timing{.divider = 0, .phase = 0, .delay = config.delay};
  if (const TriggerLine* line = config_.line_of(config); line != nullptr && devices_.trigger) {
    // A phase of whole ticks moves the tick; what is left of it delays the exposure.
    timing.divider = line->channel.divider;
    timing.phase = static_cast<int>(line->channel.phase / kTickPeriod) % timing.divider;
    timing.delay += line->channel.phase % kTickPeriod;
  }
  streams_.emplace_back();
  streams_.back().config = &config;
  streams_.back().stamp_clock = info.stamp_clock;
  streams_.back().rate_hz = info.rate_hz;
  streams_.back().pairer = sync::FramePairer(timing);
}

Result<void> LiveSession::start() {
  if (running_) return Error{ErrorCode::kUsage, "the session runs already"};
  stop_ = false;
  events_.open();
  sets_.open();
  for (Stream& stream : streams_) stream.pairer.restart();  // counters may begin anew
  running_ = true;
  sync_thread_ = std::thread([this] { run_sync(); });
  // Cameras first: what waits for a trigger must not miss the first one.
  auto started = start_cameras();
  if (started && devices_.trigger) started = start_trigger();
  if (!started) {
    stop();
    return started;
  }
  if (devices_.trigger) trigger_thread_ = std::thread([this] { run_trigger(); });
  if (devices_.pan_tilt) pan_tilt_thread_ = std::thread([this] { run_pan_tilt(); });
  return {};
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

/// One look at the master: its clock, whether it still runs, its ticks. False after an error.
bool LiveSession::follow_trigger(HostTime& next_status) {
  if (clock_.now() >= next_status) {
    next_status = clock_.now() + kStatusEvery;
    const auto status = devices_.trigger->status();
    if (!status) return false;
    if (status->state != device::TriggerState::kRunning) {
      // It was reset. Its tick numbers and its clock begin anew: ask for its time before its ticks.
      if (!start_trigger()) return false;
      next_status = clock_.now();
      push({.kind = Event::Kind::kTickRestart, .tick = {}, .stream = 0, .frame = {}});
      const std::lock_guard lock(mutex_);
      trigger_clock_ = {};
      ++counts_.trigger_restarts;
      return true;
    }
    const std::lock_guard lock(mutex_);
    (void)trigger_clock_.add(status->now, status->asked, status->answered);
  }
  std::array<device::TriggerTick, 16> ticks;
  const auto count = devices_.trigger->read_ticks(ticks, kWait);
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
    const auto sample = devices_.pan_tilt->sample();
    const auto health = devices_.pan_tilt->health();
    {
      const std::lock_guard lock(mutex_);
      counts_.pan_tilt = health;
      if (sample) {
        track_.add(*sample);
        ++counts_.pan_tilt_samples;
        continue;
      }
      ++counts_.pan_tilt_errors;
    }
    clock_.sleep_until(clock_.now() + kAfterError);
  }
}

void LiveSession::run_sync() {
  while (!stop_) {
    const auto event = events_.pop(kWait);
    if (!event) continue;
    const std::lock_guard lock(mutex_);
    on_event(*event);
    ++handled_;
  }
  const std::lock_guard lock(mutex_);
  builder_->flush();
}

void LiveSession::on_event(const Event& event) {
  switch (event.kind) {
    case Event::Kind::kTick:
      ticks_.add(event.tick);
      ++counts_.ticks;
      break;
    case Event::Kind::kTickRestart:
      for (Stream& stream : streams_) stream.pairer.restart();
      builder_->restart();
      break;
    case Event::Kind::kFrame:
      on_frame(event);
      break;
    case Event::Kind::kNone:
      break;
  }
}

void LiveSession::on_frame(const Event& event) {
  Stream& stream = streams_[event.stream];
  const device::Frame& frame = *event.frame;
  if ((frame.flags & device::kFrameRestarted) != 0) stream.pairer.restart();
  const HostTime stamp = stamp_of(stream, frame);
  if (!devices_.trigger) {
    // No master is fitted: the host's clock divided by ten milliseconds stands in for it.
    const auto number = static_cast<std::uint64_t>(stamp.time_since_epoch() / kTickPeriod);
    const sync::Tick tick{number, HostTime(static_cast<long>(number) * kTickPeriod)};
    if (const auto newest = ticks_.newest(); !newest || *newest < number) ticks_.add(tick);
  }
  if (ticks_.empty()) return;  // the stream begins before the master's first word
  const sync::Pairing pairing = stream.pairer.pair(ticks_, frame.sequence, stamp, frame.received);
  doubt_clock(stream, pairing.clock_doubted);
  if (!pairing.usable() || (frame.flags & device::kFrameIncomplete) != 0) return;
  ++stream.paired;
  stream.residual_sum_s += seconds(pairing.residual);
  stream.residual_square_s2 += seconds(pairing.residual) * seconds(pairing.residual);
  // Where a master fires, its tick is the better clock; else the stamp is all there is.
  const bool triggered = devices_.trigger && stream.config->trigger_line >= 0;
  const auto tick_time = triggered ? ticks_.time_of(pairing.tick) : std::nullopt;
  builder_->add(event.stream,
                {event.frame, pairing, tick_time ? *tick_time + stream.config->delay : stamp});
}

/// A stamp that contradicts counter and arrival again and again: somebody set the camera's clock.
void LiveSession::doubt_clock(Stream& stream, bool doubted) {
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
      stream.clock = {};  // exposed after it arrived: the camera's clock was set ahead
      return frame.received;
    }
    case device::StampClock::kNone:
      break;
  }
  return frame.received;
}

void LiveSession::emit(const sync::FrameSet& set) {
  sets_.push({set, track_.at(set.frames[0].mid_exposure)});
}

/// Read in this order, the difference is never too small.
std::uint64_t LiveSession::waiting_events() const {
  const std::uint64_t handled = handled_, dropped = events_.dropped();
  return pushed_ - handled - dropped;
}

bool LiveSession::ended() const {
  const auto over = [](const device::StreamHealth& health) {
    return health.state == device::DeviceState::kStopped ||
           health.state == device::DeviceState::kFailed;
  };
  for (const auto& camera : devices_.cameras)
    if (!over(camera->health())) return false;
  if (devices_.depth && !over(devices_.depth->health())) return false;
  return waiting_events() == 0;
}

SessionReport LiveSession::report() const {
  std::vector<device::StreamHealth> health;
  for (const auto& camera : devices_.cameras) health.push_back(camera->health());
  if (devices_.depth) health.push_back(devices_.depth->health());
  const std::lock_guard lock(mutex_);
  SessionReport report = counts_;
  report.ticks_lost = devices_.trigger ? ticks_.lost() : 0;
  report.trigger_drift_ppm = trigger_clock_.drift_ppm();
  report.sets = builder_->sets();
  report.incomplete_sets = builder_->incomplete();
  report.dropped_events = events_.dropped();
  report.dropped_sets = sets_.dropped();
  report.waiting_events = waiting_events();
  report.waiting_sets = sets_.size();
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    const Stream& stream = streams_[i];
    const double count = std::max<double>(1, static_cast<double>(stream.paired));
    const double mean_s = stream.residual_sum_s / count;
    const double variance = std::max(0.0, stream.residual_square_s2 / count - mean_s * mean_s);
    report.streams.push_back({.name = stream.config->name,
                              .uri = stream.config->uri,
                              .health = health[i],
                              .pairing = stream.pairer.counts(),
                              .drift_ppm = stream.clock.drift_ppm(),
                              .jitter_ms = milliseconds(stream.clock.jitter()),
                              .residual_mean_ms = mean_s * 1e3,
                              .residual_sd_ms = std::sqrt(variance) * 1e3});
  }
  return report;
}

}  // namespace mixrig::rig
