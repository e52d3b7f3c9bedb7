// SPDX-License-Identifier: Apache-2.0
// A queue of fixed capacity between threads.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "hal/base/clock.h"
#include "hal/base/ring.h"

namespace mixrig {

/// Holds at most N items. Any thread may call any method. Allocates only what moving a T does.
template <typename T, std::size_t N>
class BoundedQueue {
 public:
  /// Never waits: a full queue drops its oldest item and counts it.
  void push(T item) {
    [[maybe_unused]] T dropped;  // destroyed after the lock is released
    {
      const std::lock_guard lock(mutex_);
      dropped = items_.push(std::move(item));
    }
    changed_.notify_all();
  }

  /// Waits until the queue is empty, pushes, and waits until the item was taken, so that the two
  /// sides work at the same time and only one item lies between them. False, and the item is gone,
  /// if the queue was closed before.
  bool hand_over(T item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return items_.empty() || closed_; });
    if (closed_) return false;
    (void)items_.push(std::move(item));
    changed_.notify_all();
    changed_.wait(lock, [this] { return items_.empty() || closed_; });
    return true;
  }

  /// Waits at most `timeout`; empty then, or when the queue was closed and is drained.
  std::optional<T> pop(Duration timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [this] { return !items_.empty() || closed_; });
    return take_first(lock);
  }

  /// Waits without limit; empty when the queue was closed and is drained.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !items_.empty() || closed_; });
    return take_first(lock);
  }

  /// Drops the oldest items until `keep` are left, and counts them.
  void trim(std::size_t keep) {
    [[maybe_unused]] T dropped;
    for (;;) {
      const std::lock_guard lock(mutex_);
      if (items_.size() <= keep) return;
      dropped = items_.drop();
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
  std::optional<T> take_first(std::unique_lock<std::mutex>& lock) {
    if (items_.empty()) return std::nullopt;
    std::optional<T> item = items_.pop();
    lock.unlock();
    changed_.notify_all();  // hand_over() may go on
    return item;
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Ring<T, N> items_;
  bool closed_ = false;
};

}  // namespace mixrig
