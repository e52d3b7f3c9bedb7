// SPDX-License-Identifier: Apache-2.0
// Runs a sink that watches the frames of a run in its own thread.
#pragma once

#include <memory>
#include <utility>

#include "host/output/sink/sink_thread.h"

namespace mixrig::session {

/// For the compositing thread of one run. A live run never waits for the watch; a recording waits
/// after each frame given to it, so that the same take gives the same pictures. `Sink`: an
/// output::CompositeSink.
template <typename Sink>
class FrameWatch {
 public:
  void open(std::unique_ptr<Sink> sink, bool live, WorkGate* gate) {
    sink_ = sink.get(), live_ = live;
    thread_ = std::make_unique<output::SinkThread>(
        std::move(sink), live ? output::WhenFull::kDropOldest : output::WhenFull::kWait, gate);
  }
  /// Null before open().
  Sink* sink() const { return sink_; }
  /// Gives a frame to the watch. Precondition: open() was called. Errors: those of an earlier
  /// frame.
  Result<void> push(const output::CompositePtr& composite) {
    MIXRIG_TRY(thread_->push(composite));
    if (!live_) thread_->wait_until_idle();
    return {};
  }
  /// Ends the watch, if it is open. Errors: those of the watch.
  Result<void> finish() { return thread_ ? thread_->finish() : Result<void>(); }

 private:
  Sink* sink_ = nullptr;  ///< owned by thread_
  bool live_ = false;
  std::unique_ptr<output::SinkThread> thread_;
};

}  // namespace mixrig::session
