// SPDX-License-Identifier: Apache-2.0
// GPIO lines through the kernel's character device: trigger edges in, software triggers out.
#pragma once

#include <memory>
#include <string>

#include "hal/base/clock.h"
#include "hal/device/trigger.h"
#include "hal/device/trigger_input.h"

namespace mixrig::device {

/// Opens a line whose rising edges carry the kernel's CLOCK_MONOTONIC stamp. `line` is
/// "gpiochip0/17", or a chip and a line's name. Errors: kUsage, kNotFound, kDevice.
Result<std::unique_ptr<TriggerInput>> open_gpiod_input(const std::string& line);

/// Opens a SoftwareTrigger on GPIO lines, for a rig without a trigger board. `lines` is
/// "gpiochip0/17,18,22": channels 0, 1, 2. Errors: kUsage, kNotFound, kDevice.
Result<std::unique_ptr<TriggerMaster>> open_gpiod_trigger(const std::string& lines, Clock& clock);

}  // namespace mixrig::device
