// SPDX-License-Identifier: Apache-2.0
// What a take of a moving scenario has beside its pictures: tables of the head, the stream of a
// motion capture system, and the true rig. docs/formats.md describes the files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "host/calibration_file/calibration.h"
#include "host/studio/studio.h"
#include "host/take/take.h"

namespace mixrig::studio_io {

/// Tick of the 100 Hz master at which frame `number` (from 1) of scenario pan is taken.
std::uint64_t tick_of(int number);

/// The true rig as a calibration: cameras of `take`, the tracked body, the pan-tilt unit. Its base
/// is that of estimation::PanTiltChain.
calibration_file::Calibration true_calibration(const studio::StudioInfo& info,
                                               const take::TakeInfo& take);

/// Writes pan_tilt.csv and ticks.csv for the frames whose angles are given, if there are any;
/// mocap.txt, mocap_markers.csv, constellation.toml, truth/rig.json and truth/calibration.toml
/// where the camera moves. `folder` must hold a folder "truth". Errors: kIo.
Result<void> write_moving_rig(const studio::StudioOptions& options, const studio::StudioInfo& info,
                              const take::TakeInfo& take,
                              const std::vector<studio::HeadAngles>& head,
                              const std::filesystem::path& folder);

}  // namespace mixrig::studio_io
