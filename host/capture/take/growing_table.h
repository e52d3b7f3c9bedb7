// SPDX-License-Identifier: Apache-2.0
// A text file that grows by whole rows while a take is written. Private to this module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "hal/base/result.h"

namespace mixrig::take {

/// Each append() is one write: whatever ends the process, the file holds all of its rows or none.
/// Not thread-safe.
class GrowingTable {
 public:
  /// The file is made, with its header, by the first append(). One that is there is replaced.
  GrowingTable(std::filesystem::path path, std::string header)
      : path_(std::move(path)), header_(std::move(header)) {}
  GrowingTable(GrowingTable&& other) noexcept;
  GrowingTable& operator=(GrowingTable&&) = delete;
  ~GrowingTable();

  /// Appends rows, each with its line end. After an error the file is as it was before. Errors:
  /// kIo.
  Result<void> append(std::string_view rows);
  const std::filesystem::path& path() const { return path_; }
  bool is_made() const { return fd_ >= 0; }

 private:
  std::filesystem::path path_;
  std::string header_;
  int fd_ = -1;
  std::int64_t bytes_ = 0;
};

/// The text without a last line that has no end, and up to its first zero byte: a row that was cut
/// off, or what a power cut leaves of blocks that were not written.
std::string_view whole_rows(std::string_view text);

}  // namespace mixrig::take
