// SPDX-License-Identifier: Apache-2.0
#include "host/capture/open/studio.h"

#include "studio/io/studio_source.h"

namespace mixrig::session {

Result<std::unique_ptr<capture::CaptureSource>> open_studio(const std::string& options) {
  return studio_io::open_studio_source(options);
}

}  // namespace mixrig::session
