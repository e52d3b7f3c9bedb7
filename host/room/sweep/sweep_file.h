// SPDX-License-Identifier: Apache-2.0
// sweep.toml: the settings that a sweep was begun with. Only a run with equal settings may continue
// it.
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

/// Checks the folder before the devices are opened; ignores the views. Errors: kUsage where the
/// folder holds something else, or a sweep with other settings: the line names the first key that
/// differs.
Result<void> check_sweep_folder(const std::filesystem::path& folder, const SweepIdentity& identity);

/// Makes the folder and writes sweep.toml into it, or checks that the file there is equal. Errors:
/// those of check_sweep_folder(); kIo.
Result<void> begin_or_resume(const std::filesystem::path& folder, const SweepIdentity& identity);

}  // namespace mixrig::session
