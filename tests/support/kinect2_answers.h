// SPDX-License-Identifier: Apache-2.0
// What a Kinect v2 says of itself, with an infrared lens without distortion.
#pragma once

#include <bit>
#include <cstdint>

#include "extras/kinect2/emulated_kinect2.h"

namespace mixrig::test {

inline device::EmulatedKinect2::Answers kinect2_answers() {
  device::EmulatedKinect2::Answers a;
  a.phase_offsets.resize(1302572);
  for (const float v : {365.0F, 365.0F, 0.0F, 256.0F, 212.0F})
    for (int i = 0; i < 4; ++i)
      a.infrared.push_back(static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(v) >> (8 * i)));
  a.infrared.resize(92);
  a.color.resize(12981);
  return a;
}

}  // namespace mixrig::test
