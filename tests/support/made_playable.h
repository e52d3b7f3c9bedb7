// SPDX-License-Identifier: Apache-2.0
// A recording made of arithmetic, to be played as devices.
#pragma once

#include "host/rig/player.h"

namespace mixrig::test {

/// Frame k: colour (k, 100, 200) everywhere, depth k centimetres along z; 16x12 px, 25 Hz.
inline rig::Playable made_playable(int frames) {
  take::TakeInfo info;
  info.name = "made";
  info.frames = frames;
  info.color.rate_hz = info.depth.rate_hz = 25;
  info.target.pinhole = {{16, 12}, 20, 20, 7.5, 5.5};
  info.tof = info.target;
  return {info, [](int number, take::TakeFrame& frame) -> Result<void> {
            frame.color.reset({16, 12}, {static_cast<std::uint8_t>(number), 100, 200});
            frame.depth_m.reset({16, 12}, 0.01F * static_cast<float>(number));
            frame.world_from_target.translation_m = {1, 2, 3};
            return {};
          }};
}

}  // namespace mixrig::test
