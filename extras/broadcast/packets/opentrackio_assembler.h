// SPDX-License-Identifier: Apache-2.0
// Assembles the segments of an OpenTrackIO sample.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "extras/broadcast/packets/opentrackio_reader.h"

namespace mixrig::stream {

/// A whole payload; valid until the next add().
struct OpenTrackPayload {
  std::span<const std::byte> bytes;
  OpenTrackEncoding encoding = OpenTrackEncoding::kJson;
};

/// Assembles one sample at a time; segments may come in any order and twice. A sample is lost if
/// not all of its segments come before the next sample's, or if they contradict each other.
/// Bounded: samples of at most kOpenTrackMostBytes in at most kMostSegments. Not thread-safe.
class OpenTrackAssembler {
 public:
  static constexpr std::size_t kMostSegments = 64;
  OpenTrackAssembler() { bytes_.resize(kOpenTrackMostBytes); }
  std::optional<OpenTrackPayload> add(const OpenTrackSegment& segment);
  /// Numbers of lost samples, by gaps in the sequence or missing segments, and of late segments,
  /// which come after the next sample's.
  long lost() const { return lost_; }
  long late() const { return late_; }

 private:
  struct Part {
    std::uint32_t offset = 0, size = 0;
  };
  void begin(const OpenTrackSegment& segment);
  bool is_late(std::uint16_t sequence) const;
  /// Stores a segment; false where it contradicts the others.
  bool keep(const OpenTrackSegment& segment);
  bool is_whole() const;

  std::optional<std::uint16_t> sequence_;
  OpenTrackEncoding encoding_ = OpenTrackEncoding::kJson;
  bool done_ = false;  ///< delivered, or given up
  std::vector<std::byte> bytes_;
  std::array<Part, kMostSegments> parts_{};
  std::size_t count_ = 0;
  std::optional<std::uint32_t> size_;  ///< size of the sample, known once its last segment came
  std::uint32_t came_ = 0;             ///< received bytes
  long lost_ = 0, late_ = 0;
};

}  // namespace mixrig::stream
