// SPDX-License-Identifier: Apache-2.0
#include "hal/device/trigger.h"

#include <string>

#include <fmt/format.h>

namespace mixrig::device {

Result<void> check_channel(const TriggerInfo& info, int channel, const TriggerChannel& settings) {
  std::string why;
  const Duration period = settings.divider * info.tick;
  const bool off = settings.divider == 0;
  const bool whole_slots =
      settings.phase % info.slot == Duration{0} && settings.width % info.slot == Duration{0};
  const bool fits = settings.phase >= Duration{0} && settings.width >= info.slot &&
                    settings.phase < period && settings.width < period - settings.phase;
  if (channel < 0 || channel >= info.channels) {
    why = fmt::format("there are channels 0 to {}", info.channels - 1);
  } else if (settings.divider < 0 || settings.divider > info.max_divider) {
    why = fmt::format("divider must be 0 (off) to {}", info.max_divider);
  } else if (!off && !whole_slots) {
    why = fmt::format("phase and width must be multiples of {:g} ms", milliseconds(info.slot));
  } else if (!off && !fits) {
    why = fmt::format(
        "width must be at least {:g} ms, and phase + width less than {:g} ms, its period",
        milliseconds(info.slot), milliseconds(period));
  } else {
    return {};
  }
  return Error{ErrorCode::kUsage, fmt::format("trigger channel {}: {}", channel, why)};
}

}  // namespace mixrig::device
