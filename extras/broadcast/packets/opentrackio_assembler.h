// SPDX-License-Identifier: Apache-2.0
// Puts the segments of an OpenTrackIO sample together.
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

/// One sample at a time; segments may come in any order and twice. A sample whose segments did not
/// all come before the next sample's is lost, one that contradicts itself too. Bounded: samples of
/// at most kOpenTrackMostBytes in at most kMostSegments. Not thread-safe.
class OpenTrackAssembler {
 public:
  static constexpr std::size_t kMostSegments = 64;
  OpenTrackAssembler() { bytes_.resize(kOpenTrackMostBytes); }
  std::optional<OpenTrackPayload> add(const OpenTrackSegment& segment);
  /// Samples, by their sequence numbers: not or not wholly come; segments after the next sample's.
  long lost() const { return lost_; }
  long late() const { return late_; }

 private:
  struct Part {
    std::uint32_t offset = 0, size = 0;
  };
  void begin(const OpenTrackSegment& segment);
  bool is_late(std::uint16_t sequence) const;
  /// False where it contradicts the other segments.
  bool keep(const OpenTrackSegment& segment);
  bool is_whole() const;

  std::optional<std::uint16_t> sequence_;
  OpenTrackEncoding encoding_ = OpenTrackEncoding::kJson;
  bool done_ = false;  ///< delivered, or given up
  std::vector<std::byte> bytes_;
  std::array<Part, kMostSegments> parts_{};
  std::size_t count_ = 0;
  std::optional<std::uint32_t> size_;  ///< of the sample, once its last segment came
  std::uint32_t came_ = 0;             ///< bytes
  long lost_ = 0, late_ = 0;
};

}  // namespace mixrig::stream
