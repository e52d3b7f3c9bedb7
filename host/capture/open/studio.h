// SPDX-License-Identifier: Apache-2.0
// The virtual studio as a source, if the build has it. Private to this module.
#pragma once

#include <memory>
#include <string>

#include "hal/base/result.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::session {

/// studio.cpp in the profile full, no_studio.cpp in the profile board.
/// Errors: kUsage for options that the studio does not have; kUnsupported in the board profile.
Result<std::unique_ptr<capture::CaptureSource>> open_studio(const std::string& options);

}  // namespace mixrig::session
