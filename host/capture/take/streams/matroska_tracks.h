// SPDX-License-Identifier: Apache-2.0
// What a Matroska file holds (RFC 9559), found out before a decoder is started on it. Private to
// this module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/capture/take/streams/ffv1_format.h"
#include "host/capture/take/streams/picture_stream.h"

namespace mixrig::take {

/// A track of pictures.
struct MatroskaTrack {
  std::uint64_t number = 0;
  std::string name;
  Size size_px;
  std::string codec;                 ///< in words, such as "H.264"; "FFV1"
  std::vector<std::uint8_t> record;  ///< of FFV1
  std::optional<Ffv1Format> ffv1;    ///< where it is FFV1 and its header was found
};

/// Most tracks that parse_tracks() returns.
inline constexpr std::size_t kMostTracks = 64;

/// Returns the first kMostTracks tracks of pictures that the beginning of a file lists; nullopt if
/// it holds no list of tracks. Pure.
std::optional<std::vector<MatroskaTrack>> parse_tracks(std::span<const std::uint8_t> bytes);

/// The codec of raw depth pictures, big-endian, that recorders of ToF cameras write.
inline constexpr const char* kRawGray16 = "raw grey of 16 bits (b16g)";

struct MatroskaBlock {
  std::uint64_t track = 0;
  std::int64_t ticks = 0;
  std::span<const std::uint8_t> bytes;
};
struct MatroskaContents {
  double tick_s = 1e-3;
  std::vector<MatroskaTrack> tracks;
  std::vector<std::pair<std::string, std::span<const std::uint8_t>>> attachments;
  std::vector<MatroskaBlock> blocks;  ///< as they stand in the file, without laced ones
  bool is_cut = false;                ///< the last block is cut off, and left out
};
/// Most blocks that parse_contents() returns: four streams of 30 Hz for nine hours.
inline constexpr std::size_t kMostBlocks = std::size_t{1} << 22;

/// Returns what a whole file holds; its spans are those of `bytes`. Pure.
MatroskaContents parse_contents(std::span<const std::uint8_t> bytes);

/// Checks by the beginning of a file that it holds one stream of that pixel format; a damaged file
/// passes. Errors: kFormat with what it holds, kIo.
Result<void> check_tracks(const std::filesystem::path& path, PixelKind kind);

}  // namespace mixrig::take
