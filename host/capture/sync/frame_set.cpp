// SPDX-License-Identifier: Apache-2.0
#include "host/capture/sync/frame_set.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace mixrig::sync {
namespace {

std::uint64_t apart(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : b - a; }

}  // namespace

FrameSetBuilder::FrameSetBuilder(std::span<const Join> streams, FrameSetSink sink)
    : sink_(std::move(sink)) {
  for (const Join& join : streams.first(std::min(streams.size(), kMaxStreams))) {
    streams_.emplace_back();
    streams_.back().join = join;
  }
}

void FrameSetBuilder::add(std::size_t stream, TimedFrame frame) {
  if (stream >= streams_.size() || !frame.pairing.usable()) {
    ++refused_;
    return;
  }
  Stream& into = streams_[stream];
  into.newest_tick = into.any ? std::max(into.newest_tick, frame.pairing.tick) : frame.pairing.tick;
  into.any = true;
  if (stream == 0)
    waiting_[waiting_count_++] = std::move(frame);
  else
    into.kept[into.next++ % kKept] = std::move(frame);
  while (waiting_count_ > 0 && (waiting_count_ > kWaiting || all_reached(waiting_[0].pairing.tick)))
    emit_first();
}

void FrameSetBuilder::flush() {
  while (waiting_count_ > 0) emit_first();
}

void FrameSetBuilder::restart() {
  flush();
  for (Stream& stream : streams_) {
    stream.any = false;
    for (TimedFrame& kept : stream.kept) kept = {};
  }
}

bool FrameSetBuilder::all_reached(std::uint64_t tick) const {
  return std::all_of(streams_.begin() + 1, streams_.end(), [&](const Stream& s) {
    return !s.join.awaited || (s.any && s.newest_tick >= tick);
  });
}

void FrameSetBuilder::emit_first() {
  FrameSet set;
  set.frames[0] = std::move(waiting_[0]);
  set.tick = set.frames[0].pairing.tick;
  set.complete = true;
  for (std::size_t i = 1; i < streams_.size(); ++i) {
    pick(streams_[i], set.frames[0], set.frames[i]);
    set.complete = set.complete && set.frames[i].frame != nullptr;
  }
  std::move(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_),
            waiting_.begin());
  --waiting_count_;
  ++sets_;
  if (!set.complete) ++incomplete_;
  sink_(set);
}

/// Picks the stream's frame with the fewest ticks to the leading one. Of frames equally many ticks
/// away, such as those of a stream that fires half a period apart, it takes the one exposed nearer
/// in time, then the earlier one.
void FrameSetBuilder::pick(const Stream& stream, const TimedFrame& leading,
                           TimedFrame& into) const {
  const auto ticks_to = [&](const TimedFrame& frame) {
    return apart(frame.pairing.tick, leading.pairing.tick);
  };
  const auto time_to = [&](const TimedFrame& frame) {
    return std::chrono::abs(frame.mid_exposure - leading.mid_exposure);
  };
  for (const TimedFrame& candidate : stream.kept) {
    if (!candidate.frame ||
        ticks_to(candidate) > static_cast<std::uint64_t>(stream.join.farthest_ticks))
      continue;
    const auto rank = [&](const TimedFrame& frame) {
      return std::tuple(ticks_to(frame), time_to(frame), frame.pairing.tick);
    };
    if (!into.frame || rank(candidate) < rank(into)) into = candidate;
  }
}

}  // namespace mixrig::sync
