// SPDX-License-Identifier: Apache-2.0
// Elements of EBML, of which Matroska files consist (RFC 8794, RFC 9559). Private to this module.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace mixrig::take {

enum ElementId : std::uint32_t {
  kSegment = 0x18538067,
  kInfo = 0x1549A966,
  kTimestampScale = 0x2AD7B1,
  kTracks = 0x1654AE6B,
  kTrackEntry = 0xAE,
  kTrackNumber = 0xD7,
  kTrackType = 0x83,
  kTrackName = 0x536E,
  kCodecId = 0x86,
  kCodecPrivate = 0x63A2,
  kVideo = 0xE0,
  kPixelWidth = 0xB0,
  kPixelHeight = 0xBA,
  kCluster = 0x1F43B675,
  kClusterTime = 0xE7,
  kBlockGroup = 0xA0,
  kBlock = 0xA1,
  kSimpleBlock = 0xA3,
  kAttachments = 0x1941A469,
  kAttachedFile = 0x61A7,
  kFileName = 0x466E,
  kFileData = 0x465C,
};

struct Element {
  std::uint32_t id = 0;
  std::span<const std::uint8_t> body;  ///< cut where the bytes end
  bool is_cut = false;
};

/// The elements of a body, one after the other.
class Elements {
 public:
  explicit Elements(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool next(Element& out) {
    std::uint64_t id = 0, size = 0;
    if (!number(4, false, id) || !number(8, true, size)) return false;
    out.id = static_cast<std::uint32_t>(id);
    out.body = rest_.first(static_cast<std::size_t>(std::min<std::uint64_t>(size, rest_.size())));
    out.is_cut = out.body.size() < size;
    rest_ = rest_.subspan(out.body.size());
    return true;
  }

  /// A number of variable length, with or without the mark of its length. Only ones mean that the
  /// size is not known: the element goes on to the end.
  bool number(int most_bytes, bool without_mark, std::uint64_t& value) {
    if (rest_.empty()) return false;
    const int length = std::countl_zero(rest_[0]) + 1;
    if (length > most_bytes || rest_.size() < static_cast<std::size_t>(length)) return false;
    value = 0;
    for (int i = 0; i < length; ++i) value = (value << 8U) | rest_[static_cast<std::size_t>(i)];
    rest_ = rest_.subspan(static_cast<std::size_t>(length));
    if (!without_mark) return true;
    value &= (std::uint64_t{1} << (7 * length)) - 1;
    if (value == (std::uint64_t{1} << (7 * length)) - 1) value = ~std::uint64_t{0};
    return true;
  }
  std::span<const std::uint8_t> rest() const { return rest_; }

 private:
  std::span<const std::uint8_t> rest_;
};

inline std::uint64_t unsigned_of(std::span<const std::uint8_t> body) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : body.first(std::min<std::size_t>(body.size(), 8)))
    value = (value << 8U) | byte;
  return value;
}

}  // namespace mixrig::take
