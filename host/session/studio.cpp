// SPDX-License-Identifier: Apache-2.0
#include "host/session/studio.h"

#include "host/studio_io/studio_source.h"

namespace mixrig::session {

Result<std::unique_ptr<capture::CaptureSource>> open_studio(const std::string& options) {
  return studio_io::open_studio_source(options);
}

}  // namespace mixrig::session
