// SPDX-License-Identifier: Apache-2.0
#include "host/capture/calibration_file/choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace mixrig::calibration_file {
namespace {

/// A given candidate.
struct Given {
  CalibrationOrigin origin;
  std::filesystem::path file;
  std::string where, why;
  std::string unused;  ///< text about it if another one is chosen
};

void add_file(std::vector<Given>& given, const std::filesystem::path& file, const std::string& by) {
  if (file.empty()) return;
  given.push_back({CalibrationOrigin::kFile, file, file.string(), "named by " + by,
                   fmt::format("{} names {}", by, file.string())});
}

std::vector<Given> given_of(const CalibrationCandidates& candidates) {
  std::vector<Given> given;
  const std::string source = candidates.source_file.string();
  add_file(given, candidates.option, "--calibration");
  add_file(given, candidates.scene, candidates.scene_file.string());
  add_file(given, candidates.source, source);
  if (!candidates.inline_tables.empty()) {
    const std::string tables =
        fmt::format("[{}] of {}", fmt::join(candidates.inline_tables, "], ["), source);
    given.push_back(
        {CalibrationOrigin::kInlineTables, {}, tables, "no calibration.toml is named", tables});
  }
  if (candidates.reported)
    given.push_back(
        {CalibrationOrigin::kDevices,
         {},
         "the devices",
         fmt::format("no calibration.toml is named, {} has no table of a camera", source),
         "what the devices report"});
  return given;
}

}  // namespace

CalibrationChoice choose_calibration(const CalibrationCandidates& candidates) {
  const std::vector<Given> given = given_of(candidates);
  if (given.empty())
    return {CalibrationOrigin::kGuess,
            {},
            "a guess",
            "no calibration is given and the devices report none: run mixrig calibrate"};
  CalibrationChoice choice{given[0].origin, given[0].file, given[0].where, given[0].why};
  std::vector<std::string> unused;
  for (std::size_t i = 1; i < given.size(); ++i) unused.push_back(given[i].unused);
  if (!unused.empty()) choice.why += fmt::format("; not used: {}", fmt::join(unused, ", "));
  return choice;
}

}  // namespace mixrig::calibration_file
