// SPDX-License-Identifier: Apache-2.0
// libgpiod 1: lines belong to the chip and are requested one by one.
#include <gpiod.h>

#include "hal/linux/gpiod/gpiod_calls.h"
#include "hal/linux/gpiod/line_number.h"

namespace mixrig::device {
namespace {
constexpr const char* kGpioUser = "mixrig";
}

struct GpioChip {
  gpiod_chip* chip;
};
struct GpioLine {
  gpiod_line* line;
};

void CloseGpio::operator()(GpioChip* chip) const {
  gpiod_chip_close(chip->chip);
  delete chip;
}

void CloseGpio::operator()(GpioLine* line) const {
  gpiod_line_release(line->line);
  delete line;
}

GpioChipPtr open_gpio_chip(const std::string& name) {
  gpiod_chip* chip = gpiod_chip_open_lookup(name.c_str());
  return GpioChipPtr(chip != nullptr ? new GpioChip{chip} : nullptr);
}

std::optional<unsigned> find_gpio_line(GpioChip& chip, const std::string& name) {
  const auto number = line_number(name);
  gpiod_line* line = number ? gpiod_chip_get_line(chip.chip, *number)
                            : gpiod_chip_find_line(chip.chip, name.c_str());
  if (line == nullptr) return std::nullopt;
  return gpiod_line_offset(line);
}

GpioLinePtr watch_gpio_line(GpioChip& chip, unsigned offset) {
  gpiod_line* line = gpiod_chip_get_line(chip.chip, offset);
  if (line == nullptr || gpiod_line_request_rising_edge_events(line, kGpioUser) < 0) return {};
  return GpioLinePtr(new GpioLine{line});
}

GpioLinePtr drive_gpio_line(GpioChip& chip, unsigned offset, bool high) {
  gpiod_line* line = gpiod_chip_get_line(chip.chip, offset);
  if (line == nullptr || gpiod_line_request_output(line, kGpioUser, high) < 0) return {};
  return GpioLinePtr(new GpioLine{line});
}

int wait_for_edge(GpioLine& line, Duration timeout) {
  const timespec wait{static_cast<time_t>(timeout.count() / 1'000'000'000),
                      static_cast<long>(timeout.count() % 1'000'000'000)};
  return gpiod_line_event_wait(line.line, &wait);
}

std::optional<HostTime> read_edge(GpioLine& line) {
  gpiod_line_event event{};
  if (gpiod_line_event_read(line.line, &event) < 0) return std::nullopt;
  return HostTime(std::chrono::seconds(event.ts.tv_sec) + Duration(event.ts.tv_nsec));
}

bool set_level(GpioLine& line, bool high) { return gpiod_line_set_value(line.line, high) == 0; }

}  // namespace mixrig::device
