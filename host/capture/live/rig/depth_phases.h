// SPDX-License-Identifier: Apache-2.0
// Whether the two depth cameras of a rig send their light at the same time: each would then measure
// the other's light as well.
#pragma once

#include <string>

#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {

struct DepthPhases {
  bool overlap = false;  ///< they expose at the same time for sure
  bool known = true;     ///< false: rig.toml does not tell whether they do
  std::string line;      ///< one line about it: what, and what to do where it is not well
  Duration apart{};      ///< from the first one's pulse to the next one of the second, if triggered
};

/// By the phases of their trigger lines and their exposure_ms. Pure. Precondition: the rig has two
/// depth cameras.
DepthPhases depth_phases(const RigConfig& rig);

}  // namespace mixrig::live
