// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/opentrackio_assembler.h"

#include <algorithm>

namespace mixrig::stream {
namespace {

constexpr int kLateWithin = 16;     // samples: a number farther back is of a sender that restarted
constexpr int kLostWithin = 0x800;  // farther ahead too

int steps_between(std::uint16_t from, std::uint16_t to) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(to - from));
}

}  // namespace

std::optional<OpenTrackPayload> OpenTrackAssembler::add(const OpenTrackSegment& segment) {
  if (sequence_ && is_late(segment.sequence)) {
    ++late_;
    return std::nullopt;
  }
  if (!sequence_ || segment.sequence != *sequence_) begin(segment);
  if (done_) return std::nullopt;
  if (!keep(segment)) {
    done_ = true;
    ++lost_;
    return std::nullopt;
  }
  if (!is_whole()) return std::nullopt;
  done_ = true;
  return OpenTrackPayload{std::span(bytes_).first(*size_), encoding_};
}

bool OpenTrackAssembler::is_late(std::uint16_t sequence) const {
  const int step = steps_between(*sequence_, sequence);
  return (step < 0 && step >= -kLateWithin) || (step == 0 && done_);
}

void OpenTrackAssembler::begin(const OpenTrackSegment& segment) {
  if (sequence_) {
    const int step = steps_between(*sequence_, segment.sequence);
    if (step > 0 && step < kLostWithin) lost_ += step - 1;
    if (!done_) ++lost_;
  }
  sequence_ = segment.sequence;
  encoding_ = segment.encoding;
  done_ = false;
  count_ = 0;
  size_.reset();
  came_ = 0;
}

bool OpenTrackAssembler::keep(const OpenTrackSegment& segment) {
  const auto size = static_cast<std::uint32_t>(segment.payload.size());
  if (segment.encoding != encoding_ || segment.offset > kOpenTrackMostBytes ||
      size > kOpenTrackMostBytes - segment.offset)
    return false;
  const std::uint32_t end = segment.offset + size;
  if (segment.last && size_ && *size_ != end) return false;
  if (segment.last) size_ = end;
  if (size_ && end > *size_) return false;
  for (std::size_t i = 0; i < count_; ++i) {
    if (parts_[i].offset == segment.offset && parts_[i].size == size) return true;  // once more
    if (segment.offset < parts_[i].offset + parts_[i].size && parts_[i].offset < end) return false;
  }
  if (count_ == kMostSegments) return false;
  parts_[count_++] = {segment.offset, size};
  came_ += size;
  std::copy(segment.payload.begin(), segment.payload.end(),
            bytes_.begin() + static_cast<std::ptrdiff_t>(segment.offset));
  return true;
}

/// Whether all parts have come; they do not overlap.
bool OpenTrackAssembler::is_whole() const { return size_ && came_ == *size_; }

}  // namespace mixrig::stream
