// SPDX-License-Identifier: Apache-2.0
// All that knows libgpiod, version 1 (Debian 12); version 2 would be one more file like this.
#include "hal/linux/gpiod_lines.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <gpiod.h>

#include "hal/linux/software_trigger.h"

namespace mixrig::device {
namespace {

constexpr const char* kConsumer = "mixrig";
constexpr timespec kWait{0, 100'000'000};

struct CloseChip {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

struct Lines {
  Chip chip;
  std::vector<gpiod_line*> lines;  // owned by the chip
};

gpiod_line* find_line(gpiod_chip* chip, const std::string& name) {
  unsigned offset = 0;
  const auto [stop, fault] = std::from_chars(name.data(), name.data() + name.size(), offset);
  const bool number = fault == std::errc() && stop == name.data() + name.size();
  return number ? gpiod_chip_get_line(chip, offset) : gpiod_chip_find_line(chip, name.c_str());
}

Result<Lines> open_lines(const std::string& text) {
  const auto slash = text.find('/');
  if (slash == std::string::npos || slash == 0 || slash + 1 == text.size())
    return Error{ErrorCode::kUsage,
                 "gpiod:" + text + ": must be CHIP/LINE, such as gpiod:gpiochip0/17"};
  Lines found;
  found.chip.reset(gpiod_chip_open_lookup(text.substr(0, slash).c_str()));
  if (!found.chip)
    return system_error(ErrorCode::kNotFound,
                        "gpiod:" + text + ": chip cannot be opened: see gpiodetect", errno);
  for (std::size_t at = slash + 1; at <= text.size();) {
    const auto comma = std::min(text.find(',', at), text.size());
    gpiod_line* line = find_line(found.chip.get(), text.substr(at, comma - at));
    if (line == nullptr)
      return Error{ErrorCode::kNotFound, "gpiod:" + text + ": no line '" +
                                             text.substr(at, comma - at) + "': see gpioinfo"};
    found.lines.push_back(line);
    at = comma + 1;
  }
  return found;
}

class GpiodInput final : public TriggerInput {
 public:
  GpiodInput(Lines lines, Clock& clock, std::string uri)
      : lines_(std::move(lines)), clock_(clock), uri_(std::move(uri)) {}
  ~GpiodInput() override { stop(); }

  Result<void> start(EdgeSink sink) override {
    if (thread_.joinable()) return Error{ErrorCode::kUsage, uri_ + ": runs already"};
    if (gpiod_line_request_rising_edge_events(line(), kConsumer) < 0)
      return system_error(ErrorCode::kDevice, uri_ + ": line cannot be had: is it in use?", errno);
    sink_ = std::move(sink);
    stop_ = false;
    set_state(DeviceState::kStreaming);
    thread_ = std::thread([this] { work(); });
    return {};
  }
  void stop() override {
    stop_ = true;
    if (!thread_.joinable()) return;
    thread_.join();
    gpiod_line_release(line());
    set_state(DeviceState::kStopped);
  }
  StreamHealth health() const override {
    const std::lock_guard lock(mutex_);
    return health_;
  }

 private:
  gpiod_line* line() const { return lines_.lines.front(); }
  void set_state(DeviceState state) {
    const std::lock_guard lock(mutex_);
    health_.state = state;
  }
  void work() {
    std::uint64_t sequence = 0;
    while (!stop_) {
      const int ready = gpiod_line_event_wait(line(), &kWait);
      gpiod_line_event event{};
      if (ready == 0) continue;
      if (ready < 0 || gpiod_line_event_read(line(), &event) < 0) {
        // The chip was unplugged: it does not come back under the same handle.
        set_state(DeviceState::kFailed);
        return;
      }
      {
        const std::lock_guard lock(mutex_);
        ++health_.frames;
      }
      sink_({sequence++,
             HostTime(std::chrono::seconds(event.ts.tv_sec) + Duration(event.ts.tv_nsec))});
    }
  }

  Lines lines_;
  Clock& clock_;
  std::string uri_;
  EdgeSink sink_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;
  StreamHealth health_;
};

class GpiodTrigger final : public TriggerMaster {
 public:
  GpiodTrigger(Lines lines, Clock& clock, std::string uri)
      : lines_(std::move(lines)), clock_(clock) {
    info_.uri = std::move(uri);
    info_.version = "software";
    info_.clock = "CLOCK_MONOTONIC";
    info_.channels = static_cast<int>(lines_.lines.size());
    info_.tick = kSoftwareTick;
    info_.slot = std::chrono::microseconds(1);
  }
  ~GpiodTrigger() override { (void)stop(); }

  const TriggerInfo& info() const override { return info_; }
  Result<TriggerStatus> status() override;
  Result<void> configure(int channel, const TriggerChannel& settings) override;
  Result<void> start() override;
  Result<void> stop() override;
  Result<std::size_t> read_ticks(std::span<TriggerTick> out, Duration timeout) override;

 private:
  static constexpr std::size_t kKept = 256;
  void work();
  void tell(const SoftwareSchedule::Edge& edge, HostTime at);
  Result<void> request_outputs();

  Lines lines_;
  Clock& clock_;
  TriggerInfo info_;
  SoftwareSchedule schedule_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  bool requested_ = false;
  std::mutex mutex_;
  std::condition_variable told_;
  std::array<TriggerTick, kKept> ticks_{};
  std::size_t first_ = 0, count_ = 0;
  std::uint64_t tick_ = 0, overrun_ = 0, failed_ = 0;
  Duration late_max_{};
};

Result<void> GpiodTrigger::configure(int channel, const TriggerChannel& settings) {
  if (thread_.joinable())
    return Error{ErrorCode::kDevice, info_.uri + ": stop it before it is configured"};
  if (channel >= info_.channels)
    return Error{ErrorCode::kUsage,
                 info_.uri + ": has " + std::to_string(info_.channels) + " channels"};
  return schedule_.configure(channel, settings);
}

Result<void> GpiodTrigger::request_outputs() {
  if (requested_) return {};
  for (int i = 0; i < info_.channels; ++i) {
    const int idle = schedule_.channel(i).active_low ? 1 : 0;
    if (gpiod_line_request_output(lines_.lines[static_cast<std::size_t>(i)], kConsumer, idle) < 0)
      return system_error(ErrorCode::kDevice,
                          info_.uri + ": a line cannot be driven: is it in use?", errno);
  }
  requested_ = true;
  return {};
}

Result<void> GpiodTrigger::start() {
  if (thread_.joinable()) return Error{ErrorCode::kUsage, info_.uri + ": runs already"};
  MIXRIG_TRY(request_outputs());
  {
    const std::lock_guard lock(mutex_);
    count_ = 0;
    tick_ = 0;
    late_max_ = {};
  }
  schedule_.start(clock_.now() + kSoftwareTick);
  stop_ = false;
  thread_ = std::thread([this] { work(); });
  return {};
}

Result<void> GpiodTrigger::stop() {
  stop_ = true;
  if (!thread_.joinable()) return {};
  thread_.join();
  for (int i = 0; i < info_.channels; ++i)
    (void)gpiod_line_set_value(lines_.lines[static_cast<std::size_t>(i)],
                               schedule_.channel(i).active_low ? 1 : 0);
  return {};
}

void GpiodTrigger::work() {
  while (!stop_) {
    const auto edge = schedule_.next();
    clock_.sleep_until(edge.at);
    const HostTime at = clock_.now();
    if (edge.channel >= 0) {
      const bool high = edge.active != schedule_.channel(edge.channel).active_low;
      if (gpiod_line_set_value(lines_.lines[static_cast<std::size_t>(edge.channel)], high ? 1 : 0) <
          0)
        ++failed_;
    }
    tell(edge, at);
  }
}

void GpiodTrigger::tell(const SoftwareSchedule::Edge& edge, HostTime at) {
  const std::lock_guard lock(mutex_);
  late_max_ = std::max(late_max_, at - edge.at);
  if (edge.channel >= 0) return;
  if (count_ == kKept) {
    first_ = (first_ + 1) % kKept;
    --count_;
    ++overrun_;
  }
  tick_ = edge.tick;
  ticks_[(first_ + count_++) % kKept] = {edge.tick, McuTime(at.time_since_epoch()),
                                         schedule_.fired(edge.tick)};
  told_.notify_one();
}

Result<TriggerStatus> GpiodTrigger::status() {
  TriggerStatus status;
  status.asked = clock_.now();
  const std::lock_guard lock(mutex_);
  status.state = thread_.joinable() ? TriggerState::kRunning : TriggerState::kIdle;
  for (int i = 0; i < info_.channels; ++i)
    if (schedule_.channel(i).divider > 0) status.enabled |= 1U << i;
  status.tick = tick_;
  status.now = McuTime(status.asked.time_since_epoch());
  status.answered = status.asked;
  status.late_max = late_max_;
  status.faults = {{"ticks_dropped", overrun_, "tick reports that nobody fetched"},
                   {"line_failed", failed_, "a line could not be switched"}};
  return status;
}

Result<std::size_t> GpiodTrigger::read_ticks(std::span<TriggerTick> out, Duration timeout) {
  std::unique_lock lock(mutex_);
  told_.wait_for(lock, timeout, [this] { return count_ > 0; });
  std::size_t taken = 0;
  for (; taken < out.size() && count_ > 0; ++taken, --count_) {
    out[taken] = ticks_[first_];
    first_ = (first_ + 1) % kKept;
  }
  return taken;
}

}  // namespace

Result<std::unique_ptr<TriggerInput>> open_gpiod_input(const std::string& line, Clock& clock) {
  MIXRIG_ASSIGN(Lines lines, open_lines(line));
  if (lines.lines.size() != 1)
    return Error{ErrorCode::kUsage, "gpiod:" + line + ": one line is listened to, not several"};
  return std::unique_ptr<TriggerInput>(
      std::make_unique<GpiodInput>(std::move(lines), clock, "gpiod:" + line));
}

Result<std::unique_ptr<TriggerMaster>> open_gpiod_trigger(const std::string& text, Clock& clock) {
  MIXRIG_ASSIGN(Lines lines, open_lines(text));
  if (lines.lines.size() > static_cast<std::size_t>(kSoftwareChannels))
    return Error{ErrorCode::kUsage,
                 "gpiod:" + text + ": at most " + std::to_string(kSoftwareChannels) + " lines"};
  return std::unique_ptr<TriggerMaster>(
      std::make_unique<GpiodTrigger>(std::move(lines), clock, "gpiod:" + text));
}

}  // namespace mixrig::device
