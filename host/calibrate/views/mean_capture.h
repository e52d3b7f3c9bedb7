// SPDX-License-Identifier: Apache-2.0
// The mean of captures in which nothing moves.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "hal/base/image.h"
#include "host/capture/capture/capture.h"

namespace mixrig::calibration {

/// Mean pictures of all cameras of a rig while the board stood still.
struct StillView {
  Image<Rgb8> target;
  Image<Rgb8> fisheye;                      ///< empty where no picture was exposed meanwhile
  Image<std::uint16_t> amplitude;           ///< in counts of the camera; empty where it has none
  Image<std::uint16_t> depth;               ///< in steps of `depth_unit_m`, 0 = unknown
  Image<std::uint16_t> amplitude2, depth2;  ///< of a second depth camera; empty where none saw it
  std::optional<device::PanTiltAngles> pan_tilt;  ///< mean; absent unless all captures have angles
};

/// Averages the captures pixel by pixel, rounded. A depth is known where it is known in more than
/// half of the captures, and is their mean. The fisheye's picture is the mean of those whose own
/// mid-exposure lies between the first and the last plate. Precondition: at least one capture, all
/// of one rig.
StillView mean_of(std::span<const capture::Capture* const> captures, double depth_unit_m);

}  // namespace mixrig::calibration
