// SPDX-License-Identifier: Apache-2.0
// Assembles the segments of OpenTrackIO samples.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "extras/broadcast/packets/opentrackio_reader.h"
#include "extras/broadcast/packets/udp_receiver.h"

namespace mixrig::stream {

/// A whole payload; valid until the next add().
struct OpenTrackPayload {
  std::span<const std::byte> bytes;
  OpenTrackEncoding encoding = OpenTrackEncoding::kJson;
};

/// Assembles the newest kMostSamples samples of all senders; segments may come in any order and
/// twice. A header names no source, so that samples of two sources may share a sender and a number:
/// the later one takes the place of the earlier one where they contradict each other. Bounded:
/// samples of at most kOpenTrackMostBytes in at most kMostSegments. Not thread-safe.
class OpenTrackAssembler {
 public:
  static constexpr std::size_t kMostSegments = 64, kMostSamples = 8;
  OpenTrackAssembler();
  /// Returns the payload that the segment completes; one segment that is a whole sample is returned
  /// each time that it comes.
  std::optional<OpenTrackPayload> add(const OpenTrackSegment& segment, const Sender& from);

 private:
  struct Part {
    std::uint32_t offset = 0, size = 0;
    bool last = false;
    bool again = false;  ///< it came again, perhaps as a part of another sample
  };
  struct Sample {
    Sender from;
    std::uint16_t sequence = 0;
    OpenTrackEncoding encoding = OpenTrackEncoding::kJson;
    std::vector<std::byte> bytes;
    std::array<Part, kMostSegments> parts{};
    std::size_t count = 0;
    std::optional<std::uint32_t> size;  ///< size of the sample, known once its last segment came
    std::uint32_t came = 0;             ///< received bytes
    std::uint64_t used = 0;             ///< number of its last add(); 0: free
  };
  Sample& sample_of(const OpenTrackSegment& segment, const Sender& from);
  enum class Kept { kNew, kAgain, kContradicts };
  static Kept keep(const OpenTrackSegment& segment, Sample& sample);
  static void begin(const OpenTrackSegment& segment, const Sender& from, Sample& sample);
  /// Leaves of a sample what came again: the parts that another one shares with it.
  static void begin_with_shared(const OpenTrackSegment& segment, Sample& sample);

  std::array<Sample, kMostSamples> samples_;
  std::uint64_t adds_ = 0;
};

}  // namespace mixrig::stream
