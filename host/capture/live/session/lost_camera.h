// SPDX-License-Identifier: Apache-2.0
// Which camera of a rig is gone.
#pragma once

#include <optional>

#include "hal/base/result.h"
#include "host/capture/capture/source_report.h"

namespace mixrig::live {

/// kDevice with the name and URI of the first camera that is unplugged or has failed, and what to
/// check; nullopt where all are there or have ended by themselves.
std::optional<Error> lost_camera(const capture::SourceReport& report);

}  // namespace mixrig::live
