// SPDX-License-Identifier: Apache-2.0
// What gpiod_lines.cpp needs of libgpiod, by version 1 (gpiod_calls_1.cpp) or 2
// (gpiod_calls_2.cpp), whichever is installed. Private to this module. Failures leave errno.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "hal/base/clock.h"

namespace mixrig::device {

struct GpioChip;
struct GpioLine;
struct CloseGpio {
  void operator()(GpioChip* chip) const;
  void operator()(GpioLine* line) const;
};
using GpioChipPtr = std::unique_ptr<GpioChip, CloseGpio>;
using GpioLinePtr = std::unique_ptr<GpioLine, CloseGpio>;

/// `name` is that of the device file, a number, or a label. Null where there is none.
GpioChipPtr open_gpio_chip(const std::string& name);
/// The line of that name; that of an offset if `name` is a number.
std::optional<unsigned> find_gpio_line(GpioChip& chip, const std::string& name);

/// A line that reports rising edges; null where it cannot be had. The chip must outlive it.
GpioLinePtr watch_gpio_line(GpioChip& chip, unsigned offset);
/// A line that is driven.
GpioLinePtr drive_gpio_line(GpioChip& chip, unsigned offset, bool high);

/// 1 where an edge waits, 0 after `timeout`, -1 where the line is gone.
int wait_for_edge(GpioLine& line, Duration timeout);
/// The kernel's CLOCK_MONOTONIC stamp of the next edge; empty where the line is gone.
std::optional<HostTime> read_edge(GpioLine& line);
bool set_level(GpioLine& line, bool high);

}  // namespace mixrig::device
