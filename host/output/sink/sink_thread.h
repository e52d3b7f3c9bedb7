// SPDX-License-Identifier: Apache-2.0
// Runs a sink in its own thread, fed by a bounded queue.
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

/// Frame counts of a sink.
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

/// The thread has low priority unless the sink is quick, so that encoding does not take processor
/// time from the compositor. push() and finish() must be called from one thread.
class SinkThread {
 public:
  /// With `gate`, each write() of the sink is work done behind that gate; the gate must outlive
  /// this object.
  SinkThread(std::unique_ptr<CompositeSink> sink, WhenFull when_full, WorkGate* gate = nullptr);
  /// Ends the thread without calling the sink's finish().
  ~SinkThread();
  SinkThread(const SinkThread&) = delete;
  SinkThread& operator=(const SinkThread&) = delete;

  const CompositeSink& sink() const { return *sink_; }
  /// Queues a composite. Errors: that of an earlier write().
  Result<void> push(CompositePtr composite);
  /// Waits until everything pushed so far is written.
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
  std::uint64_t pushed_ = 0;  ///< by the pushing thread
  std::atomic<bool> finish_ = false;
  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable handled_one_;
  std::uint64_t handled_ = 0;  ///< composites written, or discarded after an error
  std::optional<Error> error_;
  std::thread thread_;
};

}  // namespace mixrig::output
