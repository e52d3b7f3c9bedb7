// SPDX-License-Identifier: Apache-2.0
// Whether the two depth cameras of a rig send their light at the same time: each would then measure
// the other's light as well.
#pragma once

#include <string>

#include "host/capture/live/rig/rig_config.h"

namespace mixrig::live {

struct DepthPhases {
  bool overlap = false;  ///< they certainly expose at the same time
  bool known = true;     ///< false: rig.toml does not determine whether they do
  std::string line;      ///< the finding in one line; with advice if they overlap or it is unknown
  Duration apart{};      ///< from a pulse of the first to the next of the second, if triggered
};

/// Judges by the phases of their trigger lines and their exposure_ms. Pure. Precondition: the rig
/// has two depth cameras.
DepthPhases depth_phases(const RigConfig& rig);

}  // namespace mixrig::live
