// SPDX-License-Identifier: Apache-2.0
// Adapts host/capture/depth to the Kinect v2's driver.
#pragma once

#include <memory>

#include "extras/kinect2/kinect2_camera.h"

namespace mixrig::device {

/// Makes a decoder. Depth is in steps of 0.25 mm along the ray, 0 = no distance. Confidence is 0 to
/// 65535, below DepthInfo::least_confidence where a pixel mixes surfaces. One thread.
std::unique_ptr<RawDepthDecoder> make_kinect2_decoder(const Kinect2Infrared& infrared,
                                                      const Kinect2Offsets& offsets);

}  // namespace mixrig::device
