// SPDX-License-Identifier: Apache-2.0
// Chooses the calibration if several are given.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mixrig::calibration_file {

/// Calibrations that a run can choose from, highest precedence first. An empty path: not given.
struct CalibrationCandidates {
  std::filesystem::path option;  ///< --calibration
  std::filesystem::path scene;   ///< `calibration` of scene.toml
  std::filesystem::path source;  ///< `calibration` of take.toml or rig.toml
  /// Tables of take.toml or rig.toml that hold its cameras and their poses: "target",
  /// "target_from_tof", ...
  std::vector<std::string> inline_tables{};
  bool reported = false;  ///< the devices, or the recording that they play, report intrinsics
  /// Names for `where` and `why`.
  std::filesystem::path scene_file = "scene.toml", source_file = "take.toml";
};

enum class CalibrationOrigin { kFile, kInlineTables, kDevices, kGuess };

struct CalibrationChoice {
  CalibrationOrigin origin = CalibrationOrigin::kGuess;
  std::filesystem::path file;  ///< calibration.toml to read; empty unless kFile
  std::string where;           ///< e.g. "cal.toml" or "[target] of rig.toml"
  std::string why;             ///< e.g. "named by --calibration; not used: rig.toml names old.toml"
};

/// Pure: no file is opened. Precedence: --calibration, scene.toml, the file that take.toml or
/// rig.toml names, the tables there, what the devices report, a guess.
CalibrationChoice choose_calibration(const CalibrationCandidates& candidates);

}  // namespace mixrig::calibration_file
