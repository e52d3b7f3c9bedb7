// SPDX-License-Identifier: Apache-2.0
#include "host/output/sink_thread.h"

#include <utility>

#include "hal/base/thread_priority.h"

namespace mixrig::output {

SinkThread::SinkThread(std::unique_ptr<CompositeSink> sink, WhenFull when_full)
    : sink_(std::move(sink)), when_full_(when_full) {
  thread_ = std::thread([this] { run(); });
}

SinkThread::~SinkThread() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

Result<void> SinkThread::push(CompositePtr composite) {
  MIXRIG_TRY(error());
  if (when_full_ == WhenFull::kDropOldest)
    queue_.push(std::move(composite));
  else
    queue_.push_or_wait(std::move(composite));
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

void SinkThread::run() {
  lower_thread_priority();
  Result<void> done;
  while (auto composite = queue_.pop()) {
    if (!done) continue;  // drains the queue, so that the compositor does not block
    done = sink_->write(*composite);
    if (done) {
      ++written_;
      continue;
    }
    const std::lock_guard lock(mutex_);
    error_ = done.error();
  }
  if (!done || !finish_) return;
  done = sink_->finish();
  if (done) return;
  const std::lock_guard lock(mutex_);
  error_ = done.error();
}

}  // namespace mixrig::output
