// SPDX-License-Identifier: Apache-2.0
#include "hal/device/trigger.h"

#include <cstdio>

namespace mixrig::device {

Result<void> check_channel(const TriggerInfo& info, int channel, const TriggerChannel& settings) {
  char why[128] = "";
  const Duration period = settings.divider * info.tick;
  const bool off = settings.divider == 0;
  const bool whole_slots =
      settings.phase % info.slot == Duration{0} && settings.width % info.slot == Duration{0};
  const bool fits = settings.phase >= Duration{0} && settings.width >= info.slot &&
                    settings.phase < period && settings.width < period - settings.phase;
  if (channel < 0 || channel >= info.channels) {
    std::snprintf(why, sizeof why, "there are channels 0 to %d", info.channels - 1);
  } else if (settings.divider < 0 || settings.divider > info.max_divider) {
    std::snprintf(why, sizeof why, "divider must be 0 (off) to %d", info.max_divider);
  } else if (!off && !whole_slots) {
    std::snprintf(why, sizeof why, "phase and width must be multiples of %g ms",
                  milliseconds(info.slot));
  } else if (!off && !fits) {
    std::snprintf(why, sizeof why,
                  "width must be at least %g ms, and phase + width less than %g ms, its period",
                  milliseconds(info.slot), milliseconds(period));
  } else {
    return {};
  }
  return Error{ErrorCode::kUsage, "trigger channel " + std::to_string(channel) + ": " + why};
}

}  // namespace mixrig::device
