// SPDX-License-Identifier: Apache-2.0
// sweep.toml: what a sweep was begun with. A run that differs must not go on with it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::session {

struct SweepIdentity {
  std::string rig, calibration;  ///< hashes of the files
  Size field_deg{};
  double overlap = 0;
  int view_frames = 0;
  std::vector<double> views_rad;  ///< pan and tilt of each view
};

/// Before the devices are opened, so without the views. Errors: kUsage where the folder holds
/// something else, or a sweep that was begun otherwise: the line names the first key that differs.
Result<void> check_sweep_folder(const std::filesystem::path& folder, const SweepIdentity& identity);

/// Writes sweep.toml into the folder, which is made, or finds it equal there. Errors: those of
/// check_sweep_folder; kIo.
Result<void> begin_or_resume(const std::filesystem::path& folder, const SweepIdentity& identity);

}  // namespace mixrig::session
