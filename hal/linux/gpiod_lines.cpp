// SPDX-License-Identifier: Apache-2.0
// The only file that uses libgpiod, version 1 (Debian 12); version 2 would be a second such file.
#include "hal/linux/gpiod_lines.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <gpiod.h>

#include "hal/wire/software_trigger.h"

namespace mixrig::device {
namespace {

constexpr const char* kConsumer = "mixrig";
constexpr timespec kEdgeWait{0, 100'000'000};

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
  GpiodInput(Lines lines, std::string uri) : lines_(std::move(lines)), uri_(std::move(uri)) {}
  ~GpiodInput() override { stop(); }

  Result<void> start(EdgeSink sink) override {
    if (thread_.joinable()) return Error{ErrorCode::kUsage, uri_ + ": runs already"};
    if (gpiod_line_request_rising_edge_events(line(), kConsumer) < 0)
      return system_error(ErrorCode::kDevice, uri_ + ": line cannot be requested: is it in use?",
                          errno);
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
      const int ready = gpiod_line_event_wait(line(), &kEdgeWait);
      gpiod_line_event event{};
      if (ready == 0) continue;
      if (ready < 0 || gpiod_line_event_read(line(), &event) < 0) {
        // The chip was unplugged: its handle stays invalid when it is plugged in again.
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

  int count() const override { return static_cast<int>(lines_.lines.size()); }
  Result<void> drive(int line, bool high) override {
    const auto i = static_cast<std::size_t>(line);
    const int done = requested_[i] ? gpiod_line_set_value(lines_.lines[i], high)
                                   : gpiod_line_request_output(lines_.lines[i], kConsumer, high);
    if (done < 0)
      return system_error(ErrorCode::kDevice, uri_ + ": a line cannot be driven: is it in use?",
                          errno);
    requested_[i] = true;
    return {};
  }

 private:
  Lines lines_;
  std::string uri_;
  std::array<bool, kSoftwareChannels> requested_{};
};

}  // namespace

Result<std::unique_ptr<TriggerInput>> open_gpiod_input(const std::string& line) {
  MIXRIG_ASSIGN(Lines lines, open_lines(line));
  if (lines.lines.size() != 1)
    return Error{ErrorCode::kUsage, "gpiod:" + line + ": give one line, not several"};
  return std::unique_ptr<TriggerInput>(
      std::make_unique<GpiodInput>(std::move(lines), "gpiod:" + line));
}

Result<std::unique_ptr<TriggerMaster>> open_gpiod_trigger(const std::string& text, Clock& clock) {
  MIXRIG_ASSIGN(Lines lines, open_lines(text));
  if (lines.lines.size() > static_cast<std::size_t>(kSoftwareChannels))
    return Error{ErrorCode::kUsage,
                 "gpiod:" + text + ": at most " + std::to_string(kSoftwareChannels) + " lines"};
  auto outputs = std::make_unique<GpiodOutputs>(std::move(lines), "gpiod:" + text);
  return std::unique_ptr<TriggerMaster>(
      std::make_unique<SoftwareTrigger>(std::move(outputs), clock, "gpiod:" + text));
}

}  // namespace mixrig::device
