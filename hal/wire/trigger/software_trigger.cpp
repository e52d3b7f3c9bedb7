// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/trigger/software_trigger.h"

#include <algorithm>
#include <utility>

#include "hal/base/guarded.h"
#include "hal/base/log.h"

namespace mixrig::device {

void SoftwareSchedule::configure(int channel, const TriggerChannel& settings) {
  channels_[static_cast<std::size_t>(channel)] = settings;
}

void SoftwareSchedule::start(HostTime begin) {
  begin_ = begin;
  tick_ = 0;
  for (std::size_t i = 0; i < lines_.size(); ++i) lines_[i] = {begin + channels_[i].phase, true};
}

SoftwareSchedule::Edge SoftwareSchedule::next() {
  Edge edge{.at = begin_ + static_cast<long>(tick_) * kSoftwareTick, .tick = tick_};
  for (int i = 0; i < kSoftwareChannels; ++i) {
    const Line& line = lines_[static_cast<std::size_t>(i)];
    if (channel(i).divider > 0 && line.at < edge.at) edge = {line.at, i, line.active, 0};
  }
  if (edge.channel < 0) {
    ++tick_;
    return edge;
  }
  Line& line = lines_[static_cast<std::size_t>(edge.channel)];
  const TriggerChannel& settings = channel(edge.channel);
  line.at += line.active ? settings.width : settings.divider * kSoftwareTick - settings.width;
  line.active = !line.active;
  return edge;
}

std::uint32_t SoftwareSchedule::fired(std::uint64_t tick) const {
  std::uint32_t mask = 0;
  for (int i = 0; i < kSoftwareChannels; ++i) {
    const TriggerChannel& settings = channel(i);
    if (settings.divider <= 0) continue;
    const auto first = static_cast<std::uint64_t>(settings.phase / kSoftwareTick);
    if (tick >= first && (tick - first) % static_cast<std::uint64_t>(settings.divider) == 0)
      mask |= 1U << i;
  }
  return mask;
}

SoftwareTrigger::SoftwareTrigger(std::unique_ptr<LineOutputs> lines, Clock& clock, std::string uri)
    : lines_(std::move(lines)), clock_(clock) {
  info_.uri = std::move(uri);
  info_.version = "software";
  info_.clock = "CLOCK_MONOTONIC";
  info_.channels = std::min(lines_->count(), kSoftwareChannels);
  info_.max_divider = 600;
  info_.tick = kSoftwareTick;
  info_.slot = std::chrono::microseconds(1);
}

Result<void> SoftwareTrigger::configure(int channel, const TriggerChannel& settings) {
  MIXRIG_TRY(check_channel(info_, channel, settings));
  if (thread_.joinable())
    return Error{ErrorCode::kDevice, info_.uri + ": stop it before it is configured"};
  schedule_.configure(channel, settings);
  return {};
}

/// Sets every line to its inactive level. Tries all of them; returns the first error.
Result<void> SoftwareTrigger::rest_lines() {
  Result<void> result;
  for (int i = 0; i < info_.channels; ++i) {
    auto driven = lines_->drive(i, schedule_.channel(i).active_low);
    if (!driven && result) result = std::move(driven);
  }
  return result;
}

Result<void> SoftwareTrigger::start() {
  MIXRIG_TRY(stop());
  MIXRIG_TRY(rest_lines());
  ticks_.clear();
  tick_ = 0;
  late_max_ = {};
  schedule_.start(clock_.now() + kSoftwareTick);
  stop_ = false;
  thread_ = guarded_thread(
      "trigger", [this] { work(); },
      [this](const Error& error) {
        log_warning("device", error.context + ": no more ticks come");
        stop_ = true;
      });
  return {};
}

Result<void> SoftwareTrigger::stop() {
  stop_ = true;
  if (!thread_.joinable()) return {};
  thread_.join();
  return rest_lines();
}

void SoftwareTrigger::work() {
  while (!stop_) {
    const auto edge = schedule_.next();
    clock_.sleep_until(edge.at);
    const HostTime at = clock_.now();
    bool failed = false;
    if (edge.channel >= 0) {
      const bool high = edge.active != schedule_.channel(edge.channel).active_low;
      failed = !lines_->drive(edge.channel, high);
    }
    record(edge, at, failed);
  }
}

void SoftwareTrigger::record(const SoftwareSchedule::Edge& edge, HostTime at, bool failed) {
  const std::lock_guard lock(mutex_);
  late_max_ = std::max(late_max_, at - edge.at);
  failed_ += failed;
  if (edge.channel >= 0) return;
  tick_ = edge.tick;
  (void)ticks_.push({edge.tick, McuTime(at.time_since_epoch()), schedule_.fired(edge.tick)});
  ticked_.notify_one();
}

Result<TriggerStatus> SoftwareTrigger::status() {
  TriggerStatus status;
  status.asked = clock_.now();
  const std::lock_guard lock(mutex_);
  status.state = thread_.joinable() && !stop_ ? TriggerState::kRunning : TriggerState::kIdle;
  for (int i = 0; i < info_.channels; ++i)
    if (schedule_.channel(i).divider > 0) status.enabled |= 1U << i;
  status.tick = tick_;
  status.now = McuTime(status.asked.time_since_epoch());
  status.answered = status.asked;
  status.late_max = late_max_;
  status.faults = {{"ticks_dropped", ticks_.dropped(), "tick reports that were not read in time"},
                   {"line_failed", failed_, "a line could not be switched"}};
  return status;
}

Result<std::size_t> SoftwareTrigger::read_ticks(std::span<TriggerTick> out, Duration timeout) {
  std::unique_lock lock(mutex_);
  ticked_.wait_for(lock, timeout, [this] { return !ticks_.empty(); });
  return ticks_.take(out);
}

}  // namespace mixrig::device
