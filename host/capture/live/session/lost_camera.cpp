// SPDX-License-Identifier: Apache-2.0
#include "host/capture/live/session/lost_camera.h"

#include <fmt/format.h>

namespace mixrig::live {

std::optional<Error> lost_camera(const capture::SourceReport& report) {
  for (const capture::StreamReport& stream : report.streams) {
    const device::DeviceState state = stream.health.state;
    if (state == device::DeviceState::kLost)
      return Error{ErrorCode::kDevice,
                   fmt::format("camera '{}' ({}) is lost: check its cable and power, then mixrig "
                               "diag",
                               stream.name, stream.uri)};
    if (state == device::DeviceState::kFailed)
      return Error{ErrorCode::kDevice,
                   fmt::format("camera '{}' ({}) has failed after {} frames: run mixrig diag",
                               stream.name, stream.uri, stream.health.frames)};
  }
  return std::nullopt;
}

}  // namespace mixrig::live
