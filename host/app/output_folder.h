// SPDX-License-Identifier: Apache-2.0
// A folder that appears whole or not at all.
#pragma once

#include <filesystem>

#include "hal/base/result.h"

namespace mixrig::app {

/// Files are written into staging(), which finish() renames to the folder; dropped unfinished, it
/// leaves nothing. Not thread-safe.
class OutputFolder {
 public:
  /// A folder that is there already is replaced at finish() if it is empty or holds `marker`, a
  /// file that earlier runs of the same command leave.
  /// Errors: kUsage where anything else is there; kIo.
  static Result<OutputFolder> create(const std::filesystem::path& folder, const char* marker);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&& other) noexcept;
  ~OutputFolder();

  const std::filesystem::path& staging() const { return staging_; }
  /// Errors: kIo.
  Result<void> finish();

 private:
  OutputFolder(std::filesystem::path folder, std::filesystem::path staging);
  std::filesystem::path folder_, staging_;  ///< staging_ is empty once finished or moved from
};

/// Writes a text file under a temporary name, then renames it. Errors: kIo.
Result<void> write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace mixrig::app
