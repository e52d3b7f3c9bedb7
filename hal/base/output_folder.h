// SPDX-License-Identifier: Apache-2.0
// Which folders and files an output may replace: those that mixrig made, and nothing else.
#pragma once

#include <filesystem>
#include <string_view>

#include "hal/base/result.h"

namespace mixrig {

/// The option --force of a command.
enum class Force {
  kNo,
  kYes,     ///< a warning says what is replaced
  kChecked  ///< the command was asked before: no warning
};

/// Refuses an output folder that holds files, unless it holds `marker`, the file by which its kind
/// is known. What cameras recorded (take.toml, views.toml) is replaced by --force alone. What was
/// computed is replaced as long as no file in it is newer than the marker, which its program writes
/// last. Errors: kUsage.
Result<void> check_output_folder(const std::filesystem::path& folder, const char* marker,
                                 Force force);

/// How PNG pictures and trajectories of mixrig begin.
constexpr std::string_view kPngBegin = "\x89PNG", kTrajectoryBegin = "# t x y z qx";

/// Refuses an output file that exists, is not empty and does not begin with `begin`, as what is
/// written there does. Pipes and devices pass. Errors: kUsage, naming `option`.
Result<void> check_output_file(const std::filesystem::path& file, std::string_view begin,
                               std::string_view option);

}  // namespace mixrig
