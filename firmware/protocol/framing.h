// SPDX-License-Identifier: Apache-2.0
// Frames on the wire: 00 COBS(type sequence body crc16le) 00. Freestanding, no heap, bounded.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/protocol/crc.h"

namespace mixrig::protocol {

inline constexpr std::size_t kMaxBody = 60;
inline constexpr std::size_t kMaxPlain = 2 + kMaxBody + 2;
inline constexpr std::size_t kMaxWire = 1 + 1 + kMaxPlain + 1;  ///< delimiters, COBS code, plain

/// Writes one frame; `body` has at most kMaxBody bytes, `out` room for kMaxWire.
/// Returns the bytes written, 0 where the body is too long.
constexpr std::size_t encode_frame(std::uint8_t type, std::uint8_t sequence,
                                   std::span<const std::uint8_t> body,
                                   std::span<std::uint8_t, kMaxWire> out) {
  if (body.size() > kMaxBody) return 0;
  std::array<std::uint8_t, kMaxPlain> plain{};
  std::size_t n = 0;
  plain[n++] = type;
  plain[n++] = sequence;
  for (const std::uint8_t byte : body) plain[n++] = byte;
  const std::uint16_t crc = crc16({plain.data(), n});
  plain[n++] = static_cast<std::uint8_t>(crc & 0xFFu);
  plain[n++] = static_cast<std::uint8_t>(crc >> 8);

  // COBS: each zero becomes the distance to the next one. Plain frames are shorter than 254
  // bytes, so that the long-run code 0xFF never occurs.
  std::size_t o = 0;
  out[o++] = 0;
  std::size_t code = o++;
  for (std::size_t i = 0; i < n; ++i) {
    if (plain[i] != 0) {
      out[o++] = plain[i];
    } else {
      out[code] = static_cast<std::uint8_t>(o - code);
      code = o++;
    }
  }
  out[code] = static_cast<std::uint8_t>(o - code);
  out[o++] = 0;
  return o;
}

/// Result of the last byte.
enum class FrameEvent : std::uint8_t {
  kNone,   ///< nothing yet
  kFrame,  ///< a valid frame: type(), sequence(), body()
  kBad,    ///< an invalid frame: too long, too short, wrong COBS or CRC
  kProbe,  ///< a person typed `?` and Enter
};

/// Finds frames in a byte stream. Every delimiter starts a new frame, so that a bad frame does not
/// harm the next.
class FrameDecoder {
 public:
  /// type(), sequence() and body() are valid after kFrame until the next push.
  constexpr FrameEvent push(std::uint8_t byte) {
    if (byte != 0) return collect(byte);
    const std::size_t n = fill_;
    const bool too_long = too_long_;
    reset();
    if (n == 0) return FrameEvent::kNone;
    return !too_long && unpack(n) ? FrameEvent::kFrame : FrameEvent::kBad;
  }
  /// Drops a frame that has begun.
  constexpr void reset() {
    fill_ = 0;
    too_long_ = false;
  }
  constexpr bool mid_frame() const { return fill_ != 0; }

  constexpr std::uint8_t type() const { return buffer_[0]; }
  constexpr std::uint8_t sequence() const { return buffer_[1]; }
  constexpr std::span<const std::uint8_t> body() const { return {buffer_.data() + 2, body_size_}; }

 private:
  constexpr FrameEvent collect(std::uint8_t byte) {
    if (fill_ < buffer_.size()) {
      buffer_[fill_++] = byte;
    } else {
      too_long_ = true;
    }
    // Message types 0x0A and 0x0D are never assigned, so that no frame begins like this.
    if (fill_ == 2 && buffer_[0] == '?' && (byte == '\r' || byte == '\n')) {
      reset();
      return FrameEvent::kProbe;
    }
    return FrameEvent::kNone;
  }

  /// Undoes COBS in place and checks the CRC.
  constexpr bool unpack(std::size_t n) {
    std::size_t in = 0;
    std::size_t out = 0;
    while (in < n) {
      const std::size_t end = in + buffer_[in];
      if (end > n) return false;
      ++in;
      while (in < end) buffer_[out++] = buffer_[in++];
      if (in < n) buffer_[out++] = 0;
    }
    if (out < 4) return false;
    body_size_ = out - 4;
    const unsigned stated = buffer_[out - 2] | static_cast<unsigned>(buffer_[out - 1]) << 8;
    return crc16({buffer_.data(), out - 2}) == stated;
  }

  std::array<std::uint8_t, kMaxPlain + 1> buffer_{};
  std::size_t fill_ = 0;
  std::size_t body_size_ = 0;
  bool too_long_ = false;
};

}  // namespace mixrig::protocol
