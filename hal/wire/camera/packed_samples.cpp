// SPDX-License-Identifier: Apache-2.0
#include "hal/wire/camera/packed_samples.h"

#include <algorithm>

namespace mixrig::device {
namespace {

/// Writes samples of `bits` bits as 16-bit ones.
class SampleWriter {
 public:
  SampleWriter(std::uint8_t* out, int bits) : out_(out), up_(16 - bits), down_(2 * bits - 16) {}
  void put(unsigned sample) {
    const unsigned scaled = sample << up_ | sample >> down_;
    out_[0] = static_cast<std::uint8_t>(scaled);
    out_[1] = static_cast<std::uint8_t>(scaled >> 8);
    out_ += 2;
  }

 private:
  std::uint8_t* out_;
  int up_, down_;
};

void unpack_words(const std::uint8_t* in, int bits, int width, SampleWriter out) {
  const unsigned mask = (1U << bits) - 1;
  for (int x = 0; x < width; ++x, in += 2)
    out.put((static_cast<unsigned>(in[0]) | static_cast<unsigned>(in[1]) << 8) & mask);
}

void unpack_mipi(const std::uint8_t* in, int bits, int width, SampleWriter out) {
  const int low = bits - 8, group = 8 / low;
  for (int x = 0; x < width; x += group, in += group + 1)
    for (int i = 0; i < std::min(group, width - x); ++i)
      out.put(static_cast<unsigned>(in[i]) << low |
              ((static_cast<unsigned>(in[group]) >> (i * low)) & ((1U << low) - 1)));
}

/// Unpacks a stream of bits. The bits of a sample lie in at most three bytes; none beyond its last
/// one is read.
void unpack_bits(const std::uint8_t* in, int bits, bool big, int width, SampleWriter out) {
  const auto row_bytes = (static_cast<std::size_t>(width) * static_cast<std::size_t>(bits) + 7) / 8;
  const unsigned mask = (1U << bits) - 1;
  std::size_t at = 0;  // bits
  for (int x = 0; x < width; ++x, at += static_cast<std::size_t>(bits)) {
    unsigned window = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t byte = at / 8 + i;
      const unsigned value = byte < row_bytes ? in[byte] : 0;
      window |= value << (big ? 16 - 8 * i : 8 * i);
    }
    const auto within = static_cast<unsigned>(at % 8);
    out.put((big ? window >> (24 - static_cast<unsigned>(bits) - within) : window >> within) &
            mask);
  }
}

}  // namespace

std::size_t packed_row_bytes(SamplePacking packing, int bits, int width) {
  if (width <= 0 || bits < 10 || bits > 16) return 0;
  const auto count = static_cast<std::size_t>(width), depth = static_cast<std::size_t>(bits);
  switch (packing) {
    case SamplePacking::kNone:
      return 0;
    case SamplePacking::kWords:
      return 2 * count;
    case SamplePacking::kMipi:
      return bits == 10 ? (count + 3) / 4 * 5 : bits == 12 ? (count + 1) / 2 * 3 : 0;
    case SamplePacking::kBig:
    case SamplePacking::kLittle:
      return (count * depth + 7) / 8;
  }
  return 0;
}

bool unpack_samples(const PackedSamples& layout, std::span<const std::uint8_t> in,
                    std::span<std::uint8_t> out) {
  const std::size_t row = packed_row_bytes(layout.packing, layout.bits, layout.size.width);
  if (row == 0 || layout.size.empty() || layout.stride_bytes < row) return false;
  const auto rows = static_cast<std::size_t>(layout.size.height);
  if (in.size() < row || (in.size() - row) / layout.stride_bytes < rows - 1 ||
      out.size() < 2 * layout.size.area())
    return false;
  const std::uint8_t* from = in.data();
  std::uint8_t* to = out.data();
  for (std::size_t y = 0; y < rows; ++y, from += layout.stride_bytes) {
    const SampleWriter writer(to, layout.bits);
    if (layout.packing == SamplePacking::kWords)
      unpack_words(from, layout.bits, layout.size.width, writer);
    else if (layout.packing == SamplePacking::kMipi)
      unpack_mipi(from, layout.bits, layout.size.width, writer);
    else
      unpack_bits(from, layout.bits, layout.packing == SamplePacking::kBig, layout.size.width,
                  writer);
    to += 2 * static_cast<std::size_t>(layout.size.width);
  }
  return true;
}

}  // namespace mixrig::device
