// SPDX-License-Identifier: Apache-2.0
// A queue of fixed capacity: when full it drops its oldest item and counts it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace mixrig {

/// Holds at most N items. Allocates only what moving a T does. For one thread.
template <typename T, std::size_t N>
class Ring {
 public:
  /// Appends an item. Returns the item that was dropped for it, or T{}.
  T push(T item) {
    T forgotten = count_ == N ? drop() : T{};
    items_[(first_ + count_++) % N] = std::move(item);
    return forgotten;
  }
  /// The oldest item. Precondition of front(), pop() and drop(): the ring is not empty.
  T& front() { return items_[first_]; }
  T pop() {
    T item = std::exchange(items_[first_], T{});
    first_ = (first_ + 1) % N;
    --count_;
    return item;
  }
  /// Does what pop() does, and counts the item as dropped.
  T drop() {
    ++dropped_;
    return pop();
  }
  /// Moves items to `out`, the oldest first; returns how many.
  std::size_t take(std::span<T> out) {
    std::size_t taken = 0;
    while (taken < out.size() && count_ > 0) out[taken++] = pop();
    return taken;
  }
  void clear() {
    while (count_ > 0) (void)pop();
  }
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  /// Number of items dropped since construction.
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::array<T, N> items_{};
  std::size_t first_ = 0, count_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace mixrig
