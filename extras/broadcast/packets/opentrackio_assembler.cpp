// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/packets/opentrackio_assembler.h"

#include <algorithm>

namespace mixrig::stream {

OpenTrackAssembler::OpenTrackAssembler() {
  for (Sample& sample : samples_) sample.bytes.resize(kOpenTrackMostBytes);
}

std::optional<OpenTrackPayload> OpenTrackAssembler::add(const OpenTrackSegment& segment,
                                                        const Sender& from) {
  if (segment.offset == 0 && segment.last)
    return OpenTrackPayload{segment.payload, segment.encoding};
  Sample& sample = sample_of(segment, from);
  sample.used = ++adds_;
  Kept kept = keep(segment, sample);
  if (kept == Kept::kContradicts) {
    begin_with_shared(segment, sample);
    kept = keep(segment, sample);
  }
  if (kept != Kept::kNew || !sample.size || sample.came != *sample.size) return std::nullopt;
  return OpenTrackPayload{std::span(sample.bytes).first(*sample.size), sample.encoding};
}

OpenTrackAssembler::Sample& OpenTrackAssembler::sample_of(const OpenTrackSegment& segment,
                                                          const Sender& from) {
  const auto is_of = [&](const Sample& sample) {
    return sample.used > 0 && sample.sequence == segment.sequence &&
           sample.from.address == from.address && sample.from.port == from.port;
  };
  const auto there = std::find_if(samples_.begin(), samples_.end(), is_of);
  if (there != samples_.end()) return *there;
  const auto older = [](const Sample& a, const Sample& b) { return a.used < b.used; };
  Sample& oldest = *std::min_element(samples_.begin(), samples_.end(), older);
  begin(segment, from, oldest);
  return oldest;
}

void OpenTrackAssembler::begin(const OpenTrackSegment& segment, const Sender& from,
                               Sample& sample) {
  sample.from = from;
  sample.sequence = segment.sequence;
  sample.encoding = segment.encoding;
  sample.count = 0;
  sample.size.reset();
  sample.came = 0;
}

void OpenTrackAssembler::begin_with_shared(const OpenTrackSegment& segment, Sample& sample) {
  const auto end = sample.parts.begin() + static_cast<std::ptrdiff_t>(sample.count);
  const auto shared =
      std::stable_partition(sample.parts.begin(), end, [](const Part& part) { return part.again; });
  const auto count = static_cast<std::size_t>(shared - sample.parts.begin());
  begin(segment, sample.from, sample);
  for (std::size_t i = 0; i < count; ++i) {
    Part& part = sample.parts[i];
    part.again = false;
    sample.came += part.size;
    if (part.last) sample.size = part.offset + part.size;
  }
  sample.count = count;
}

OpenTrackAssembler::Kept OpenTrackAssembler::keep(const OpenTrackSegment& segment, Sample& sample) {
  const auto size = static_cast<std::uint32_t>(segment.payload.size());
  if (segment.encoding != sample.encoding || segment.offset > kOpenTrackMostBytes ||
      size > kOpenTrackMostBytes - segment.offset)
    return Kept::kContradicts;
  const std::uint32_t end = segment.offset + size;
  const auto at = sample.bytes.begin() + static_cast<std::ptrdiff_t>(segment.offset);
  for (std::size_t i = 0; i < sample.count; ++i) {
    Part& part = sample.parts[i];
    if (part.offset == segment.offset && part.size == size && part.last == segment.last) {
      if (!std::equal(segment.payload.begin(), segment.payload.end(), at))
        return Kept::kContradicts;
      part.again = true;
      return Kept::kAgain;
    }
    if (segment.offset < part.offset + part.size && part.offset < end) return Kept::kContradicts;
  }
  if (sample.count == kMostSegments || (segment.last && sample.size) ||
      (sample.size && end > *sample.size))
    return Kept::kContradicts;
  if (segment.last) sample.size = end;
  sample.parts[sample.count++] = {segment.offset, size, segment.last, false};
  sample.came += size;
  std::copy(segment.payload.begin(), segment.payload.end(), at);
  return Kept::kNew;
}

}  // namespace mixrig::stream
