// SPDX-License-Identifier: Apache-2.0
// Poses of the target camera on a pan-tilt head, from its angles and the calibrated chain.
#pragma once

#include <memory>
#include <optional>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/capture/pose_source.h"

namespace mixrig::pose {

/// Returns base_from_target at encoder angles; calibration_file::PanTilt defines the chain.
geometry::Pose base_from_target(const calibration_file::PanTilt& unit,
                                const device::PanTiltAngles& encoder);

/// Returns the covariance of base_from_target at these angles: that of the calibration (if `unit`
/// holds the 16 x 16 matrix of estimation::calibrate_pan_tilt), plus the repeatability of angle and
/// position, and the encoders' rounding to whole steps. nullopt if none of them is known.
std::optional<capture::PoseCovariance> covariance_of(const calibration_file::PanTilt& unit,
                                                     const device::PanTiltAngles& encoder);

/// Makes a source of world_from_base * base_from_target at Capture::pan_tilt, the angles at
/// mid-exposure. Without angles there is no pose.
std::unique_ptr<capture::PoseSource> make_pan_tilt_poses(const calibration_file::PanTilt& unit,
                                                         const geometry::Pose& world_from_base);

}  // namespace mixrig::pose
