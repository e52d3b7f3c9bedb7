// SPDX-License-Identifier: Apache-2.0
#include "host/capture/open/studio.h"

namespace mixrig::session {

Result<std::unique_ptr<capture::CaptureSource>> open_studio(const std::string& options) {
  return Error{ErrorCode::kUnsupported,
               "--source studio:" + options +
                   ": the board's build has no virtual studio: record a take with mixrig studio on "
                   "another machine and use take:DIR"};
}

}  // namespace mixrig::session
