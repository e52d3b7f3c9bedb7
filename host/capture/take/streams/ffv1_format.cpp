// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/ffv1_format.h"

#include <algorithm>
#include <array>

namespace mixrig::take {
namespace {

/// State after a one, by the state before (RFC 9043, 3.8.1.4).
constexpr std::array<std::uint8_t, 256> kAfterOne{
    0,   0,   0,   0,   0,   0,   0,   0,   20,  21,  22,  23,  24,  25,  26,  27,  28,  29,  30,
    31,  32,  33,  34,  35,  36,  37,  37,  38,  39,  40,  41,  42,  43,  44,  45,  46,  47,  48,
    49,  50,  51,  52,  53,  54,  55,  56,  56,  57,  58,  59,  60,  61,  62,  63,  64,  65,  66,
    67,  68,  69,  70,  71,  72,  73,  74,  75,  75,  76,  77,  78,  79,  80,  81,  82,  83,  84,
    85,  86,  87,  88,  89,  90,  91,  92,  93,  94,  94,  95,  96,  97,  98,  99,  100, 101, 102,
    103, 104, 105, 106, 107, 108, 109, 110, 111, 112, 113, 114, 114, 115, 116, 117, 118, 119, 120,
    121, 122, 123, 124, 125, 126, 127, 128, 129, 130, 131, 132, 133, 133, 134, 135, 136, 137, 138,
    139, 140, 141, 142, 143, 144, 145, 146, 147, 148, 149, 150, 151, 152, 152, 153, 154, 155, 156,
    157, 158, 159, 160, 161, 162, 163, 164, 165, 166, 167, 168, 169, 170, 171, 171, 172, 173, 174,
    175, 176, 177, 178, 179, 180, 181, 182, 183, 184, 185, 186, 187, 188, 189, 190, 190, 191, 192,
    194, 194, 195, 196, 197, 198, 199, 200, 201, 202, 202, 204, 205, 206, 207, 208, 209, 209, 210,
    211, 212, 213, 215, 215, 216, 217, 218, 219, 220, 220, 222, 223, 224, 225, 226, 227, 227, 229,
    229, 230, 231, 232, 234, 234, 235, 236, 237, 238, 239, 240, 241, 242, 243, 244, 245, 246, 247,
    248, 248, 0,   0,   0,   0,   0,   0,   0};

constexpr std::size_t kContexts = 32;
using Ffv1States = std::array<std::uint8_t, kContexts>;

/// The range decoder of RFC 9043, 3.8.1. Past the end it reads zeros.
class Ffv1Bits {
 public:
  explicit Ffv1Bits(std::span<const std::uint8_t> bytes) : rest_(bytes) {
    low_ = next_byte() << 8U;
    low_ |= next_byte();
  }

  bool bit(std::uint8_t& state) {
    const std::uint32_t of_one = (range_ * state) >> 8U;
    range_ -= of_one;
    const bool one = low_ >= range_;
    if (one) {
      low_ -= range_, range_ = of_one;
      state = kAfterOne[state];
    } else {
      state = static_cast<std::uint8_t>(256 - kAfterOne[static_cast<std::uint8_t>(256 - state)]);
    }
    if (range_ < 0x100) range_ <<= 8U, low_ = (low_ << 8U) | next_byte();
    return one;
  }

  /// A number by its bits' count, its bits and its sign; nullopt where it has over 31 bits.
  std::optional<int> number(Ffv1States& states, bool is_signed) {
    if (bit(states[0])) return 0;
    int count = 0;
    while (bit(states[1 + static_cast<std::size_t>(std::min(count, 9))]))
      if (++count > 30) return std::nullopt;
    int value = 1;
    for (int i = count - 1; i >= 0; --i)
      value = 2 * value + (bit(states[22 + static_cast<std::size_t>(std::min(i, 9))]) ? 1 : 0);
    const bool negative =
        is_signed && bit(states[11 + static_cast<std::size_t>(std::min(count, 10))]);
    return negative ? -value : value;
  }

 private:
  std::uint32_t next_byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t byte = rest_[0];
    rest_ = rest_.subspan(1);
    return byte;
  }

  std::span<const std::uint8_t> rest_;
  std::uint32_t low_ = 0, range_ = 0xFF00;
};

Ffv1States fresh_states() {
  Ffv1States states;
  states.fill(128);
  return states;
}

/// The parameters from `version` on, which lie in the record or behind a frame's first bit.
std::optional<Ffv1Format> read_parameters(Ffv1Bits& bits, bool in_record) {
  Ffv1States states = fresh_states();
  bool whole = true;
  const auto number = [&](bool is_signed = false) {
    const auto value = bits.number(states, is_signed);
    whole = whole && value.has_value();
    return value.value_or(0);
  };
  const int version = number();
  if (!whole || version > 4 || in_record != (version >= 2)) return std::nullopt;
  if (version >= 3) (void)number();  // the minor version
  const int coder = number();
  if (coder > 2) return std::nullopt;
  if (coder == 2)
    for (int i = 1; i < 256; ++i) (void)number(true);
  Ffv1Format format;
  const int space = number();
  if (version > 0) format.bits = number();
  if (format.bits == 0) format.bits = 8;
  format.rgb = space == 1;
  format.chroma = bits.bit(states[0]);
  format.log2_across = number(), format.log2_down = number();
  format.alpha = bits.bit(states[0]);
  const bool sound = whole && space <= 1 && format.bits >= 8 && format.bits <= 16 &&
                     std::max(format.log2_across, format.log2_down) <= 4;
  return sound ? std::optional(format) : std::nullopt;
}

}  // namespace

std::optional<Ffv1Format> ffv1_format(std::span<const std::uint8_t> record,
                                      std::span<const std::uint8_t> first_frame) {
  if (record.size() > 4) {
    Ffv1Bits bits(record);
    return read_parameters(bits, true);
  }
  if (first_frame.size() < 4) return std::nullopt;
  Ffv1Bits bits(first_frame);
  std::uint8_t key_state = 128;
  if (!bits.bit(key_state)) return std::nullopt;  // no key frame: no header
  return read_parameters(bits, false);
}

std::string text_of(const Ffv1Format& format) {
  std::string name = "YUV";
  const int across = format.log2_across, down = format.log2_down;
  if (across == 0 && down == 0) name = "YUV 4:4:4";
  if (across == 1 && down == 0) name = "YUV 4:2:2";
  if (across == 1 && down == 1) name = "YUV 4:2:0";
  if (!format.chroma) name = "grey";
  if (format.rgb) name = "RGB";
  if (format.alpha) name += " with transparency";
  return name + " of " + std::to_string(format.bits) + " bits";
}

}  // namespace mixrig::take
