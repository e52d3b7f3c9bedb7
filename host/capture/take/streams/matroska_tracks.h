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
#include <vector>

#include "hal/base/result.h"
#include "host/capture/take/streams/ffv1_format.h"
#include "host/capture/take/streams/picture_stream.h"

namespace mixrig::take {

/// A track of pictures.
struct MatroskaTrack {
  std::uint64_t number = 0;
  std::string codec;                 ///< in words, such as "H.264"; "FFV1"
  std::vector<std::uint8_t> record;  ///< of FFV1
  std::optional<Ffv1Format> ffv1;    ///< where it is FFV1 and its header was found
};

/// Most tracks that parse_tracks() returns.
inline constexpr std::size_t kMostTracks = 64;

/// Returns the first kMostTracks tracks of pictures that the beginning of a file lists; nullopt if
/// it holds no list of tracks. Pure.
std::optional<std::vector<MatroskaTrack>> parse_tracks(std::span<const std::uint8_t> bytes);

/// Checks by the beginning of a file that it holds one stream of that pixel format; a damaged file
/// passes. Errors: kFormat with what it holds, kIo.
Result<void> check_tracks(const std::filesystem::path& path, PixelKind kind);

}  // namespace mixrig::take
