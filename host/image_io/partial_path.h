// SPDX-License-Identifier: Apache-2.0
// A file or folder that appears whole or not at all.
#pragma once

#include <filesystem>

#include "hal/base/result.h"

namespace mixrig::image_io {

/// A name beside the wanted one to write under: `x.png` is written as `x.png.partial`. What lies
/// under that name is removed at the start and, unless commit() was called, at the end.
class PartialPath {
 public:
  explicit PartialPath(std::filesystem::path wanted);
  PartialPath(const PartialPath&) = delete;
  PartialPath& operator=(const PartialPath&) = delete;
  ~PartialPath();

  /// Where to write.
  const std::filesystem::path& path() const { return partial_; }
  /// Gives it the wanted name, in place of a file or folder that has it. Errors: kIo; then
  /// what had the name before is still there.
  Result<void> commit();

 private:
  std::filesystem::path wanted_, partial_;
};

}  // namespace mixrig::image_io
