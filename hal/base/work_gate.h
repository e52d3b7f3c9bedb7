// SPDX-License-Identifier: Apache-2.0
// Keeps background work out of a measured interval.
#pragma once

#include <condition_variable>
#include <mutex>

namespace mixrig {

/// Pieces of background work may run at the same time, but not while a Pause lives. Work that has
/// begun is not interrupted: a Pause waits for it, and no further piece begins meanwhile. For one
/// pausing thread and any number of working ones. A piece of work must not wait for the pausing
/// thread.
class WorkGate {
 public:
  /// Marks a piece of work of the calling thread; waits until no Pause lives. Does nothing if
  /// `gate` is null.
  class Work {
   public:
    explicit Work(WorkGate* gate) : gate_(gate) {
      if (gate_ == nullptr) return;
      std::unique_lock lock(gate_->mutex_);
      gate_->changed_.wait(lock, [this] { return !gate_->paused_; });
      ++gate_->working_;
    }
    ~Work() {
      if (gate_ == nullptr) return;
      const std::lock_guard lock(gate_->mutex_);
      --gate_->working_;
      gate_->changed_.notify_all();
    }
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;

   private:
    WorkGate* const gate_;
  };

  /// Waits until no work runs, and lets none begin while it lives. Does nothing if `gate` is null.
  class Pause {
   public:
    explicit Pause(WorkGate* gate) : gate_(gate) {
      if (gate_ == nullptr) return;
      std::unique_lock lock(gate_->mutex_);
      gate_->paused_ = true;
      gate_->changed_.wait(lock, [this] { return gate_->working_ == 0; });
    }
    ~Pause() {
      if (gate_ == nullptr) return;
      const std::lock_guard lock(gate_->mutex_);
      gate_->paused_ = false;
      gate_->changed_.notify_all();
    }
    Pause(const Pause&) = delete;
    Pause& operator=(const Pause&) = delete;

   private:
    WorkGate* const gate_;
  };

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_ = false;
  int working_ = 0;
};

}  // namespace mixrig
