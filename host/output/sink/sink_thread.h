// SPDX-License-Identifier: Apache-2.0
// Runs a sink in a thread of its own, fed by a bounded queue.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "hal/base/bounded_queue.h"
#include "hal/base/work_gate.h"
#include "host/output/sink/composite_sink.h"

namespace mixrig::output {

/// Counts of a sink.
struct SinkReport {
  std::string name;
  std::uint64_t written = 0;
  std::uint64_t dropped = 0;  ///< because the sink was too slow
};

/// Behaviour of push() when the queue is full.
enum class WhenFull {
  kDropOldest,  ///< live: the compositor is never delayed
  kWait,        ///< a recording: every frame is written
};

/// The thread runs at low priority, but for a sink that is quick, so that encoding does not take
/// the processor from the compositor. push() and finish() are for one thread.
class SinkThread {
 public:
  /// With a gate, each write() of the sink is a piece of work behind it; it must outlive this.
  SinkThread(std::unique_ptr<CompositeSink> sink, WhenFull when_full, WorkGate* gate = nullptr);
  /// Ends the thread without finish().
  ~SinkThread();
  SinkThread(const SinkThread&) = delete;
  SinkThread& operator=(const SinkThread&) = delete;

  const CompositeSink& sink() const { return *sink_; }
  /// Errors: that of an earlier write().
  Result<void> push(CompositePtr composite);
  /// Waits until all that was pushed is written.
  void wait_until_idle();
  /// Waits until the queue is written, then finishes the sink and ends the thread.
  /// Errors: those of write() and finish().
  Result<void> finish();
  SinkReport report() const;

 private:
  void run();
  Result<void> write(const CompositePtr& composite);
  Result<void> error() const;

  std::unique_ptr<CompositeSink> sink_;
  const WhenFull when_full_;
  WorkGate* const gate_;
  BoundedQueue<CompositePtr, 2> queue_;
  std::atomic<std::uint64_t> written_ = 0;
  std::uint64_t pushed_ = 0;  ///< of the pushing thread
  std::atomic<bool> finish_ = false;
  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable handled_one_;
  std::uint64_t handled_ = 0;  ///< composites that were written, or discarded after an error
  std::optional<Error> error_;
  std::thread thread_;
};

}  // namespace mixrig::output
