// SPDX-License-Identifier: Apache-2.0
// The pixel format of an FFV1 stream, from its header (RFC 9043, 4.2 and 4.3). Private to this
// module.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace mixrig::take {

struct Ffv1Format {
  int bits = 8;  ///< of a sample
  bool rgb = false, chroma = false, alpha = false;
  int log2_across = 0, log2_down = 0;  ///< of colour samples in YUV
  bool is_gray() const { return !rgb && !chroma && !alpha; }
};

/// Reads the format from the configuration record or, in streams without one (FFV1 versions 0 and
/// 1), from the first frame; nullopt if neither holds a header. Pure.
std::optional<Ffv1Format> ffv1_format(std::span<const std::uint8_t> record,
                                      std::span<const std::uint8_t> first_frame);

/// Returns the format in words, such as "grey of 12 bits" or "YUV 4:2:0 of 8 bits".
std::string text_of(const Ffv1Format& format);

}  // namespace mixrig::take
