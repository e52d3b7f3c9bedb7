// SPDX-License-Identifier: Apache-2.0
// The bytes of a file that may be larger than the memory. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

#include "hal/base/result.h"

namespace mixrig::take {

/// A file mapped for reading. One that gets shorter meanwhile does not end the process: its lost
/// bytes, and those behind them, read as 0. Not thread-safe; at most eight at a time.
class MappedFile {
 public:
  /// Errors: kNotFound, kUnsupported for a ninth.
  static Result<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&& other) noexcept
      : path_(std::move(other.path_)),
        bytes_(std::exchange(other.bytes_, {})),
        guard_(other.guard_) {}
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile();

  std::span<const std::uint8_t> bytes() const { return bytes_; }
  /// Returns `done`, or an error where the file got shorter while it was read.
  Result<void> if_whole(Result<void> done) const;

 private:
  MappedFile(std::filesystem::path path, std::span<const std::uint8_t> bytes, std::size_t guard)
      : path_(std::move(path)), bytes_(bytes), guard_(guard) {}
  std::filesystem::path path_;
  std::span<const std::uint8_t> bytes_;
  std::size_t guard_;
};

}  // namespace mixrig::take
