// SPDX-License-Identifier: Apache-2.0
// A queue without locks between one producer and one consumer (interrupt and main loop).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace mixrig::firmware {

template <typename T, std::uint32_t N>
class Ring {
  static_assert((N & (N - 1)) == 0, "a power of two");

 public:
  /// Producer only. Appends a value; false if the queue is full.
  bool push(const T& value) {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == N) return false;
    slots_[head & (N - 1)] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// Consumer only. Returns the oldest value, valid until pop(); null if the queue is empty.
  const T* front() const {
    const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return nullptr;
    return &slots_[tail & (N - 1)];
  }
  /// Consumer only, after front() returned a value.
  void pop() { tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }
  bool pop(T& value) {
    const T* first = front();
    if (first == nullptr) return false;
    value = *first;
    pop();
    return true;
  }
  /// Producer only. At least this many pushes will succeed.
  std::uint32_t free() const { return N - (head_.load() - tail_.load()); }
  bool empty() const { return head_.load() == tail_.load(); }

 private:
  std::array<T, N> slots_{};
  std::atomic<std::uint32_t> head_{0};
  std::atomic<std::uint32_t> tail_{0};
};

}  // namespace mixrig::firmware
