// SPDX-License-Identifier: Apache-2.0
// ticks.csv and pan_tilt.csv of a recorded take: tick, time and head angle of each frame. Private
// to this room.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/pan_tilt.h"

namespace mixrig::take {

struct FrameTick {
  std::uint64_t tick = 0;
  HostTime mid_exposure{};  ///< on the recording host's clock
};

/// ticks.csv: tick and mid-exposure of the plate of each frame, by frame number. A frame's first
/// row is its plate's. Pure. Errors: kFormat (name:line: ...).
Result<std::map<int, FrameTick>> parse_ticks(std::string_view text, const std::string& name);
/// pan_tilt.csv: angles of the head by frame number. Pure. Errors: kFormat (name:line: ...).
Result<std::map<int, device::PanTiltAngles>> parse_pan_tilt(std::string_view text,
                                                            const std::string& name);

}  // namespace mixrig::take
