// SPDX-License-Identifier: Apache-2.0
// Something that watches the composited frames of a run on a thread of its own.
#pragma once

#include <memory>
#include <utility>

#include "host/output/sink/sink_thread.h"

namespace mixrig::session {

/// For the compositing thread of one run. A live run never waits for the watch; that of a recording
/// does after each frame that is looked at, so that the same take gives the same pictures.
/// `Sink`: an output::CompositeSink.
template <typename Sink>
class FrameWatch {
 public:
  void open(std::unique_ptr<Sink> sink, bool live, WorkGate* gate) {
    sink_ = sink.get(), live_ = live;
    thread_ = std::make_unique<output::SinkThread>(
        std::move(sink), live ? output::WhenFull::kDropOldest : output::WhenFull::kWait, gate);
  }
  /// Null while it is closed.
  Sink* sink() const { return sink_; }
  /// Precondition: open. Errors: those of an earlier frame.
  Result<void> push(const output::CompositePtr& composite) {
    MIXRIG_TRY(thread_->push(composite));
    if (!live_) thread_->wait_until_idle();
    return {};
  }
  /// Ends the watch, if it is open. Errors: those of the watch.
  Result<void> finish() { return thread_ ? thread_->finish() : Result<void>(); }

 private:
  Sink* sink_ = nullptr;  ///< that of thread_
  bool live_ = false;
  std::unique_ptr<output::SinkThread> thread_;
};

}  // namespace mixrig::session
