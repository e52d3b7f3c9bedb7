// SPDX-License-Identifier: Apache-2.0
// A short queue between threads: the newest matter, so a full one forgets its oldest and counts.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "hal/base/clock.h"

namespace mixrig::rig {

/// Holds at most N. Any threads. Nothing allocates but what moving a T does.
template <typename T, std::size_t N>
class BoundedQueue {
 public:
  void push(T item) {
    [[maybe_unused]] T forgotten;  // destroyed after the lock is released
    {
      const std::lock_guard lock(mutex_);
      if (count_ == N) {
        forgotten = std::move(items_[first_]);
        first_ = (first_ + 1) % N;
        --count_;
        ++dropped_;
      }
      items_[(first_ + count_++) % N] = std::move(item);
    }
    changed_.notify_one();
  }

  /// Waits at most `timeout`; empty then, or when the queue was closed and is drained.
  std::optional<T> pop(Duration timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [this] { return count_ > 0 || closed_; });
    if (count_ == 0) return std::nullopt;
    std::optional<T> item(std::move(items_[first_]));
    items_[first_] = T{};
    first_ = (first_ + 1) % N;
    --count_;
    return item;
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
    return count_;
  }
  std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::array<T, N> items_{};
  std::size_t first_ = 0, count_ = 0;
  std::uint64_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace mixrig::rig
