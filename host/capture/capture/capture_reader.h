// SPDX-License-Identifier: Apache-2.0
// Reads and decodes captures in a thread of their own, ahead of the compositor.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <thread>

#include "hal/base/bounded_queue.h"
#include "hal/base/pool.h"
#include "hal/base/result.h"
#include "hal/base/work_gate.h"
#include "host/capture/capture/capture_source.h"

namespace mixrig::capture {

/// A capture, and its truth if that was requested.
struct CaptureItem {
  CapturePtr capture;
  std::shared_ptr<const Truth> truth;
};

/// Reads ahead; at most two captures wait. For a live source the oldest is dropped and counted; for
/// a recording the thread waits, so that every frame is composited. While the reader lives nothing
/// else may use the source. next() is for one thread.
class CaptureReader {
 public:
  /// Starts to read `first`..`last`. The source and the gate must outlive the reader. With a gate,
  /// each read() of the source is a piece of work behind it.
  CaptureReader(CaptureSource& source, int first, int last, bool with_truth,
                WorkGate* gate = nullptr);
  /// Ends the thread; a live source that delivers nothing delays this until its read() returns.
  ~CaptureReader();
  CaptureReader(const CaptureReader&) = delete;
  CaptureReader& operator=(const CaptureReader&) = delete;

  /// Waits for the next capture and returns it. Empty after `last` or when the source has ended.
  /// Errors: those of the source; nothing follows them.
  Result<std::optional<CaptureItem>> next();
  /// Captures that were dropped because the consumer was too slow.
  std::uint64_t dropped() const { return queue_.dropped(); }

 private:
  struct Slot {
    CaptureItem item;
    std::optional<Error> error;
  };
  void run(int first, int last);
  Result<bool> read(int number, CaptureItem& item);
  bool push(Slot slot);

  CaptureSource& source_;
  WorkGate* const gate_;
  const bool with_truth_, live_;
  Pool<Capture> captures_;
  Pool<Truth> truths_;
  BoundedQueue<Slot, 2> queue_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace mixrig::capture
