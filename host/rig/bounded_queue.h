// SPDX-License-Identifier: Apache-2.0
// A short queue between threads: the newest matter, so a full one forgets its oldest and counts.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "hal/base/clock.h"
#include "hal/base/ring.h"

namespace mixrig::rig {

/// Holds at most N. Any threads. Nothing allocates but what moving a T does.
template <typename T, std::size_t N>
class BoundedQueue {
 public:
  void push(T item) {
    [[maybe_unused]] T forgotten;  // destroyed after the lock is released
    {
      const std::lock_guard lock(mutex_);
      forgotten = items_.push(std::move(item));
    }
    changed_.notify_one();
  }

  /// Waits at most `timeout`; empty then, or when the queue was closed and is drained.
  std::optional<T> pop(Duration timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [this] { return !items_.empty() || closed_; });
    if (items_.empty()) return std::nullopt;
    return items_.pop();
  }

  /// Forgets the oldest ones until `keep` are left, and counts them.
  void trim(std::size_t keep) {
    [[maybe_unused]] T forgotten;
    for (;;) {
      const std::lock_guard lock(mutex_);
      if (items_.size() <= keep) return;
      forgotten = items_.drop();
    }
  }

  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }
  void open() {
    const std::lock_guard lock(mutex_);
    closed_ = false;
  }
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return items_.size();
  }
  std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return items_.dropped();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Ring<T, N> items_;
  bool closed_ = false;
};

}  // namespace mixrig::rig
