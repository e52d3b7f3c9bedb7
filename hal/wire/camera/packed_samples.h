// SPDX-License-Identifier: Apache-2.0
// Unpacks grey and Bayer samples of 10 to 16 bits as cameras pack them. Pure functions that never
// read past a buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/image.h"

namespace mixrig::device {

enum class SamplePacking {
  kNone,    ///< not packed: bytes as they are
  kWords,   ///< one sample in the low bits of a little-endian 16-bit word (V4L2 Y10, RG12 ...)
  kMipi,    ///< MIPI CSI-2 RAW10 and RAW12: the upper 8 bits of 4 or 2 samples, a byte each, then
            ///< one byte of their low bits, the first sample's lowest (V4L2 Y10P, pRAA, pRCC ...)
  kBig,     ///< a stream of bits, the highest of a byte first (V4L2 Y10B)
  kLittle,  ///< a stream of bits, the lowest of a byte first (PFNC Mono10p, BayerRG12p ...)
};

struct PackedSamples {
  SamplePacking packing = SamplePacking::kNone;
  int bits = 16;  ///< bits per sample: 10, 12, 14 or 16; with kMipi 10 or 12
  Size size;
  std::size_t stride_bytes = 0;  ///< bytes from row to row
};

/// Returns the bytes of one row; 0 for kNone and for numbers of bits that the packing does not
/// have.
std::size_t packed_row_bytes(SamplePacking packing, int bits, int width);

/// Unpacks into little-endian 16-bit samples without padding whose full scale is 65535: the upper
/// bits of a sample are repeated below it. Returns false if `in` or `out` is too small.
bool unpack_samples(const PackedSamples& layout, std::span<const std::uint8_t> in,
                    std::span<std::uint8_t> out);

}  // namespace mixrig::device
