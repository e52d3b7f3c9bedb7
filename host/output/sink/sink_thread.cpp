// SPDX-License-Identifier: Apache-2.0
#include "host/output/sink/sink_thread.h"

#include <utility>

#include "hal/base/guarded.h"
#include "hal/base/thread_priority.h"

namespace mixrig::output {

SinkThread::SinkThread(std::unique_ptr<CompositeSink> sink, WhenFull when_full, WorkGate* gate)
    : sink_(std::move(sink)), when_full_(when_full), gate_(gate) {
  thread_ = std::thread([this] { run(); });
}

SinkThread::~SinkThread() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

Result<void> SinkThread::push(CompositePtr composite) {
  MIXRIG_TRY(error());
  ++pushed_;
  if (when_full_ == WhenFull::kDropOldest)
    queue_.push(std::move(composite));
  else
    queue_.hand_over(std::move(composite));
  return {};
}

Result<void> SinkThread::finish() {
  finish_ = true;
  queue_.close();
  if (thread_.joinable()) thread_.join();
  return error();
}

SinkReport SinkThread::report() const {
  return {std::string(sink_->name()), written_, queue_.dropped()};
}

Result<void> SinkThread::error() const {
  const std::lock_guard lock(mutex_);
  return error_ ? Result<void>(*error_) : Result<void>();
}

void SinkThread::wait_until_idle() {
  std::unique_lock lock(mutex_);
  handled_one_.wait(lock, [this] { return handled_ + queue_.dropped() >= pushed_; });
}

Result<void> SinkThread::write(const CompositePtr& composite) {
  const WorkGate::Work work(gate_);
  return guarded(sink_->name(), [&] { return sink_->write(composite); });
}

void SinkThread::run() {
  if (!sink_->is_quick()) lower_thread_priority();
  bool failed = false;
  while (auto composite = queue_.pop()) {
    // After an error the queue is still emptied, so that the compositor does not block.
    const Result<void> done = failed ? Result<void>() : write(*composite);
    composite.reset();
    const std::lock_guard lock(mutex_);
    if (!done) error_ = done.error();
    written_ += done && !failed ? 1 : 0;
    failed |= !done;
    ++handled_;
    handled_one_.notify_all();
  }
  if (failed || !finish_) return;
  const auto done = guarded(sink_->name(), [&] { return sink_->finish(); });
  if (done) return;
  const std::lock_guard lock(mutex_);
  error_ = done.error();
}

}  // namespace mixrig::output
