// SPDX-License-Identifier: Apache-2.0
// A live moment as a frame of a take: what recording and compositing start from.
#pragma once

#include "host/rig/devices.h"
#include "host/rig/live_session.h"
#include "host/take/take.h"

namespace mixrig::rig {

/// The cameras of a live rig: rig.toml's calibration, else that of the recording that plays, else
/// what the devices tell, else a guess of 60 degrees that `mixrig calibrate` replaces.
/// Errors: kUsage for a rig without a camera or without a depth camera.
Result<take::TakeInfo> take_info(const RigConfig& config, const Devices& devices);

/// Colour, depth in metres and amplitude of a set; keeps the memory of `frame`, and leaves its
/// number, time and pose alone. Errors: kData where the set lacks colour or depth, or one of them
/// cannot be read: leave the set out.
Result<void> to_take_frame(const LiveSet& set, const Devices& devices, take::TakeFrame& frame);

/// Where the target camera stands: rig.toml's place, else that of the recording, else the origin.
geometry::Pose world_from_target(const RigConfig& config, const Devices& devices);

}  // namespace mixrig::rig
