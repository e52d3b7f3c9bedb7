// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/rig/device_kind.h"

#include <fmt/format.h>

namespace mixrig::live {

Error extra_left_out(const std::string& what, std::string_view extra) {
  return {
      ErrorCode::kUnsupported,
      fmt::format("{}: this build is without the extra \"{}\": build mixrig with it in the CMake "
                  "list MIXRIG_EXTRAS",
                  what, extra)};
}

}  // namespace mixrig::live
