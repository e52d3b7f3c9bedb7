// SPDX-License-Identifier: Apache-2.0
// Files of a moving scenario's take besides its pictures: tables of the head, the stream of a
// motion capture system, and the true rig. docs/reference/studio.md describes the files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/take/take.h"
#include "studio/studio.h"

namespace mixrig::studio_io {

/// Tick of the 100 Hz master at which frame `number` (from 1) of scenario pan is taken.
std::uint64_t tick_of(int number);

/// The foot of the unit in the world; its axes are those of estimation::PanTiltChain. `info` must
/// have a unit.
geometry::Pose world_from_base(const studio::StudioInfo& info);
/// Seconds to add to a stamp of the motion capture system to get the time of the take at which its
/// pose was true. Exact in the middle of the take; the drift adds less than 5e-5 of the time from
/// there. `info` must have a system.
double mocap_time_offset_s(const studio::StudioInfo& info);

/// The true rig as a calibration: cameras of `take`, the fisheye where the take has one, the
/// tracked body, the pan-tilt unit. Its base is that of estimation::PanTiltChain.
calibration_file::Calibration true_calibration(const studio::StudioInfo& info,
                                               const take::TakeInfo& take);

/// Writes pan_tilt.csv and ticks.csv for the frames whose angles are given, if there are any;
/// mocap.txt, mocap_target.txt, mocap_markers.csv, constellation.toml, truth/rig.json and
/// truth/calibration.toml where the camera moves; the last also where the take has a fisheye.
/// `folder` must hold a folder "truth". Errors: kIo.
Result<void> write_moving_rig(const studio::StudioOptions& options, const studio::StudioInfo& info,
                              const take::TakeInfo& take,
                              const std::vector<studio::HeadAngles>& head,
                              const std::filesystem::path& folder);

}  // namespace mixrig::studio_io
