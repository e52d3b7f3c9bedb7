// SPDX-License-Identifier: Apache-2.0
// libgpiod 2: lines are requested with settings, and a request holds them.
#include <filesystem>

#include <gpiod.h>

#include "hal/linux/gpiod/gpiod_calls.h"
#include "hal/linux/gpiod/line_number.h"

namespace mixrig::device {
namespace {

constexpr const char* kGpioUser = "mixrig";

template <auto kFree>
struct FreeGpiod {
  void operator()(auto* object) const { kFree(object); }
};
using Settings = std::unique_ptr<gpiod_line_settings, FreeGpiod<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, FreeGpiod<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, FreeGpiod<gpiod_request_config_free>>;
using ChipInfo = std::unique_ptr<gpiod_chip_info, FreeGpiod<gpiod_chip_info_free>>;

}  // namespace

struct GpioChip {
  gpiod_chip* chip;
};
struct GpioLine {
  gpiod_line_request* request;
  unsigned offset;
  gpiod_edge_event_buffer* events;
};

namespace {

gpiod_chip* chip_of_label(const std::string& label) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev", error)) {
    const std::string path = entry.path();
    if (!path.starts_with("/dev/gpiochip")) continue;
    gpiod_chip* chip = gpiod_chip_open(path.c_str());
    if (chip == nullptr) continue;
    const ChipInfo info(gpiod_chip_get_info(chip));
    if (info && label == gpiod_chip_info_get_label(info.get())) return chip;
    gpiod_chip_close(chip);
  }
  return nullptr;
}

GpioLinePtr request(GpioChip& chip, unsigned offset, const Settings& settings) {
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig config(gpiod_request_config_new());
  if (!settings || !lines || !config) return {};
  gpiod_request_config_set_consumer(config.get(), kGpioUser);
  if (gpiod_line_config_add_line_settings(lines.get(), &offset, 1, settings.get()) < 0) return {};
  gpiod_line_request* made = gpiod_chip_request_lines(chip.chip, config.get(), lines.get());
  if (made == nullptr) return {};
  GpioLinePtr line(new GpioLine{made, offset, gpiod_edge_event_buffer_new(1)});
  return line->events != nullptr ? std::move(line) : GpioLinePtr();
}

}  // namespace

void CloseGpio::operator()(GpioChip* chip) const {
  gpiod_chip_close(chip->chip);
  delete chip;
}

void CloseGpio::operator()(GpioLine* line) const {
  gpiod_line_request_release(line->request);
  if (line->events != nullptr) gpiod_edge_event_buffer_free(line->events);
  delete line;
}

GpioChipPtr open_gpio_chip(const std::string& name) {
  const std::string file = (line_number(name) ? "/dev/gpiochip" : "/dev/") + name;
  gpiod_chip* chip = gpiod_chip_open(file.c_str());
  if (chip == nullptr) chip = chip_of_label(name);
  return GpioChipPtr(chip != nullptr ? new GpioChip{chip} : nullptr);
}

std::optional<unsigned> find_gpio_line(GpioChip& chip, const std::string& name) {
  if (const auto number = line_number(name)) {
    const ChipInfo info(gpiod_chip_get_info(chip.chip));
    if (!info || *number >= gpiod_chip_info_get_num_lines(info.get())) return std::nullopt;
    return number;
  }
  const int offset = gpiod_chip_get_line_offset_from_name(chip.chip, name.c_str());
  if (offset < 0) return std::nullopt;
  return static_cast<unsigned>(offset);
}

GpioLinePtr watch_gpio_line(GpioChip& chip, unsigned offset) {
  const Settings settings(gpiod_line_settings_new());
  if (!settings) return {};
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
  gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_RISING);
  gpiod_line_settings_set_event_clock(settings.get(), GPIOD_LINE_CLOCK_MONOTONIC);
  return request(chip, offset, settings);
}

GpioLinePtr drive_gpio_line(GpioChip& chip, unsigned offset, bool high) {
  const Settings settings(gpiod_line_settings_new());
  if (!settings) return {};
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  gpiod_line_settings_set_output_value(settings.get(),
                                       high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE);
  return request(chip, offset, settings);
}

int wait_for_edge(GpioLine& line, Duration timeout) {
  return gpiod_line_request_wait_edge_events(line.request, timeout.count());
}

std::optional<HostTime> read_edge(GpioLine& line) {
  if (gpiod_line_request_read_edge_events(line.request, line.events, 1) < 1) return std::nullopt;
  gpiod_edge_event* event = gpiod_edge_event_buffer_get_event(line.events, 0);
  return HostTime(Duration(static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event))));
}

bool set_level(GpioLine& line, bool high) {
  return gpiod_line_request_set_value(line.request, line.offset,
                                      high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE) ==
         0;
}

}  // namespace mixrig::device
