// SPDX-License-Identifier: Apache-2.0
// Finds the camera of a rig that is lost.
#pragma once

#include <optional>

#include "hal/base/result.h"
#include "host/capture/capture/source_report.h"

namespace mixrig::live {

/// Returns a kDevice error with the name and URI of the first camera that is unplugged or has
/// failed, and what to check; nullopt if all are present or have ended by themselves.
std::optional<Error> lost_camera(const capture::SourceReport& report);

}  // namespace mixrig::live
