// SPDX-License-Identifier: Apache-2.0
// Files and folders that appear whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

#include "hal/base/result.h"

namespace mixrig {

/// A name beside the wanted one to write under: `x.png` is written as `x.png.partial`. A file or
/// folder of that name is removed by the constructor and, unless commit() or keep() was called, by
/// the destructor. If the wanted name is a symbolic link, its target is replaced and the link
/// stays. Not thread-safe.
class PartialPath {
 public:
  explicit PartialPath(std::filesystem::path wanted);
  PartialPath(PartialPath&& other) noexcept;
  PartialPath& operator=(PartialPath&& other) noexcept;
  ~PartialPath();

  /// Path to write under until commit().
  const std::filesystem::path& path() const { return partial_; }
  /// Leaves what was written under the partial name: it cannot be made again. Nothing is written by
  /// this object afterwards.
  void keep() { wanted_.clear(), partial_.clear(); }
  /// Renames it to the wanted name and replaces a file or folder that has it. Errors: kIo; kUsage
  /// where a file would replace a folder or a device. After an error the old content is still
  /// there.
  Result<void> commit();

 private:
  std::filesystem::path wanted_, partial_;  ///< empty once moved from
};

/// An empty folder under its partial name. At commit() it replaces a folder that is empty or holds
/// `marker`, a file that earlier runs of the same command leave.
/// Errors: kUsage where anything else has the name; kIo.
Result<PartialPath> make_partial_folder(const std::filesystem::path& folder, const char* marker);

/// Writes a whole file or leaves what was there; writes to a pipe or device as it is, such as
/// /dev/stdout. Errors: kIo; kUsage where a folder has the name.
Result<void> write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace mixrig
