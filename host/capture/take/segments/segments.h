// SPDX-License-Identifier: Apache-2.0
// Takes of one recording that follow each other in a folder: FOLDER/0001, FOLDER/0002, ...
// TakeReader::open() reads such a folder as one take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "hal/base/result.h"

namespace mixrig::take {

/// A take in a folder of segments.
struct Segment {
  int number = 0;
  std::filesystem::path path;
  bool is_partial = false;  ///< it is being written, or was cut off
};

/// The segments of a folder by their number: folders of its form that have a manifest, are
/// being written, or are empty. Empty for a folder that is a take itself, has none, or
/// cannot be read.
std::vector<Segment> segments_of(const std::filesystem::path& folder);
/// Path of the segment after the last one; makes the folder. Errors: kUsage where the folder holds
/// anything but segments; kIo.
Result<std::filesystem::path> next_segment(const std::filesystem::path& folder);
/// Bytes of all files below a folder.
std::uint64_t bytes_below(const std::filesystem::path& folder);

}  // namespace mixrig::take
