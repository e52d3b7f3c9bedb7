// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/gpiod/gpiod_lines.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "hal/base/guarded.h"
#include "hal/device/stream_count.h"
#include "hal/linux/gpiod/gpiod_calls.h"
#include "hal/wire/trigger/software_trigger.h"

namespace mixrig::device {
namespace {

constexpr Duration kEdgeWait = std::chrono::milliseconds(100);

struct Lines {
  GpioChipPtr chip;
  std::vector<unsigned> offsets;
};

Result<Lines> open_lines(const std::string& text) {
  const auto slash = text.find('/');
  if (slash == std::string::npos || slash == 0 || slash + 1 == text.size())
    return Error{ErrorCode::kUsage,
                 "gpiod:" + text + ": must be CHIP/LINE, such as gpiod:gpiochip0/17"};
  Lines found;
  found.chip = open_gpio_chip(text.substr(0, slash));
  if (!found.chip)
    return system_error(ErrorCode::kNotFound,
                        "gpiod:" + text + ": chip cannot be opened: see gpiodetect", errno);
  for (std::size_t at = slash + 1; at <= text.size();) {
    const auto comma = std::min(text.find(',', at), text.size());
    const auto offset = find_gpio_line(*found.chip, text.substr(at, comma - at));
    if (!offset)
      return Error{ErrorCode::kNotFound, "gpiod:" + text + ": no line '" +
                                             text.substr(at, comma - at) + "': see gpioinfo"};
    found.offsets.push_back(*offset);
    at = comma + 1;
  }
  return found;
}

class GpiodInput final : public TriggerInput {
 public:
  GpiodInput(Lines lines, std::string uri) : lines_(std::move(lines)), uri_(std::move(uri)) {}
  ~GpiodInput() override { stop(); }

  Result<void> start(EdgeSink sink) override {
    if (thread_.joinable()) return Error{ErrorCode::kUsage, uri_ + ": runs already"};
    line_ = watch_gpio_line(*lines_.chip, lines_.offsets.front());
    if (!line_)
      return system_error(ErrorCode::kDevice, uri_ + ": line cannot be requested: is it in use?",
                          errno);
    sink_ = std::move(sink);
    stop_ = false;
    set_state(DeviceState::kStreaming);
    thread_ = guarded_thread(
        "gpiod", [this] { work(); },
        [this](const Error& error) {
          log_end_of_driver(error);
          set_state(DeviceState::kFailed);
        });
    return {};
  }
  void stop() override {
    stop_ = true;
    if (!thread_.joinable()) return;
    thread_.join();
    line_.reset();
    set_state(DeviceState::kStopped);
  }
  StreamHealth health() const override {
    const std::lock_guard lock(mutex_);
    return health_;
  }

 private:
  void set_state(DeviceState state) {
    const std::lock_guard lock(mutex_);
    health_.state = state;
  }
  void work() {
    std::uint64_t sequence = 0;
    while (!stop_) {
      const int ready = wait_for_edge(*line_, kEdgeWait);
      if (ready == 0) continue;
      const auto at = ready > 0 ? read_edge(*line_) : std::nullopt;
      if (!at) {
        // The chip was unplugged: its handle stays invalid when it is plugged in again.
        set_state(DeviceState::kFailed);
        return;
      }
      {
        const std::lock_guard lock(mutex_);
        ++health_.frames;
      }
      sink_({sequence++, *at});
    }
  }

  Lines lines_;
  GpioLinePtr line_;  ///< set while it runs
  std::string uri_;
  EdgeSink sink_;
  std::thread thread_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;
  StreamHealth health_;
};

class GpiodOutputs final : public LineOutputs {
 public:
  GpiodOutputs(Lines lines, std::string uri) : lines_(std::move(lines)), uri_(std::move(uri)) {}

  int count() const override { return static_cast<int>(lines_.offsets.size()); }
  Result<void> drive(int line, bool high) override {
    const auto i = static_cast<std::size_t>(line);
    bool done = false;
    if (driven_[i]) {
      done = set_level(*driven_[i], high);
    } else {
      driven_[i] = drive_gpio_line(*lines_.chip, lines_.offsets[i], high);
      done = driven_[i] != nullptr;
    }
    if (!done)
      return system_error(ErrorCode::kDevice, uri_ + ": a line cannot be driven: is it in use?",
                          errno);
    return {};
  }

 private:
  Lines lines_;
  std::string uri_;
  std::array<GpioLinePtr, kSoftwareChannels> driven_{};
};

}  // namespace

Result<std::unique_ptr<TriggerInput>> open_gpiod_input(const std::string& line) {
  MIXRIG_ASSIGN(Lines lines, open_lines(line));
  if (lines.offsets.size() != 1)
    return Error{ErrorCode::kUsage, "gpiod:" + line + ": give one line, not several"};
  return std::unique_ptr<TriggerInput>(
      std::make_unique<GpiodInput>(std::move(lines), "gpiod:" + line));
}

Result<std::unique_ptr<TriggerMaster>> open_gpiod_trigger(const std::string& text, Clock& clock) {
  MIXRIG_ASSIGN(Lines lines, open_lines(text));
  if (lines.offsets.size() > static_cast<std::size_t>(kSoftwareChannels))
    return Error{ErrorCode::kUsage,
                 "gpiod:" + text + ": at most " + std::to_string(kSoftwareChannels) + " lines"};
  auto outputs = std::make_unique<GpiodOutputs>(std::move(lines), "gpiod:" + text);
  return std::unique_ptr<TriggerMaster>(
      std::make_unique<SoftwareTrigger>(std::move(outputs), clock, "gpiod:" + text));
}

}  // namespace mixrig::device
