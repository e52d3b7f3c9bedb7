// SPDX-License-Identifier: Apache-2.0
// Frames of several cameras that belong to one moment.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hal/device/frame.h"
#include "host/capture/sync/pairing.h"

namespace mixrig::sync {

inline constexpr std::size_t kMaxStreams = 6;

/// A frame with its place in time.
struct TimedFrame {
  device::FramePtr frame;
  Pairing pairing;
  HostTime mid_exposure{};
};

/// Frames of one moment: stream 0 leads; each other stream has the frame nearest to it, or none.
struct FrameSet {
  std::uint64_t tick = 0;
  std::array<TimedFrame, kMaxStreams> frames;
  bool complete = false;  ///< every stream has a frame
};

using FrameSetSink = std::function<void(const FrameSet&)>;

/// How a stream is joined to the leading one.
struct Join {
  int farthest_ticks = 0;  ///< largest distance of its frame from the leading one
  /// A set waits until the stream has reached its tick. False for slower streams: sets would
  /// accumulate until their next frame and then be emitted in one burst.
  bool awaited = true;
};

/// Joins streams by tick. A set is emitted when every awaited stream has reached its tick, or when
/// the leading stream is two frames further: a camera that stops sending does not stop the others.
/// Each stream contributes the nearest frame that has arrived.
/// Nothing allocates after construction. One thread.
class FrameSetBuilder {
 public:
  /// One entry per stream; entry 0, the leading stream, is not used.
  FrameSetBuilder(std::span<const Join> streams, FrameSetSink sink);

  /// Adds a frame; one whose pairing is not usable is refused and counted.
  void add(std::size_t stream, TimedFrame frame);
  /// Emits the waiting sets.
  void flush();
  /// Emits the waiting sets and drops all other frames, since tick numbers restart.
  void restart();

  std::uint64_t sets() const { return sets_; }
  std::uint64_t incomplete() const { return incomplete_; }
  std::uint64_t refused() const { return refused_; }

 private:
  static constexpr std::size_t kKept = 4;
  static constexpr std::size_t kWaiting = 2;
  struct Stream {
    Join join;
    std::array<TimedFrame, kKept> kept;
    std::size_t next = 0;
    std::uint64_t newest_tick = 0;
    bool any = false;
  };
  bool all_reached(std::uint64_t tick) const;
  void emit_first();
  void pick(const Stream& stream, const TimedFrame& leading, TimedFrame& into) const;

  std::vector<Stream> streams_;
  FrameSetSink sink_;
  std::array<TimedFrame, kWaiting + 1> waiting_;
  std::size_t waiting_count_ = 0;
  std::uint64_t sets_ = 0, incomplete_ = 0, refused_ = 0;
};

}  // namespace mixrig::sync
