// SPDX-License-Identifier: Apache-2.0
// Calls to libgpiod that gpiod_lines.cpp needs, implemented for version 1 (gpiod_calls_1.cpp) and
// version 2 (gpiod_calls_2.cpp), whichever is installed. Private to this module. Failures leave
// errno.
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

/// Opens a chip by the name of its device file, its number or its label. Null if there is none.
GpioChipPtr open_gpio_chip(const std::string& name);
/// Returns the offset of the line of that name, or `name` itself if it is a number.
std::optional<unsigned> find_gpio_line(GpioChip& chip, const std::string& name);

/// Requests a line that reports rising edges; null on failure. The chip must outlive it.
GpioLinePtr watch_gpio_line(GpioChip& chip, unsigned offset);
/// Requests a line as output with this level; null on failure. The chip must outlive it.
GpioLinePtr drive_gpio_line(GpioChip& chip, unsigned offset, bool high);

/// Waits for an edge. Returns 1 where one waits, 0 after `timeout`, -1 where the line is gone.
int wait_for_edge(GpioLine& line, Duration timeout);
/// Reads the kernel's CLOCK_MONOTONIC stamp of the next edge; empty if the line is gone.
std::optional<HostTime> read_edge(GpioLine& line);
bool set_level(GpioLine& line, bool high);

}  // namespace mixrig::device
