// SPDX-License-Identifier: Apache-2.0
#include "hal/device/frame_pool.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace mixrig::device {

/// Memory of a pool. Lives until the last frame of it is dropped.
struct FrameSlots {
  struct Slot {
    std::vector<std::uint8_t> bytes, amplitude, confidence;
    Frame frame;
    /// Room for the shared_ptr's control block, so that publishing does not allocate.
    alignas(std::max_align_t) std::array<std::byte, 128> control;
  };
  std::mutex mutex;
  std::vector<std::unique_ptr<Slot>> slots;
  std::vector<int> free;

  void give_back(int index) {
    const std::lock_guard lock(mutex);
    free.push_back(index);  // capacity was reserved
  }
};

namespace {

/// Places the shared_ptr's control block in the slot. The slot becomes free when that block is
/// deallocated, which is after the last reference to the frame is gone.
template <typename T>
struct SlotAllocator {
  using value_type = T;
  std::shared_ptr<FrameSlots> slots;
  int index;

  SlotAllocator(std::shared_ptr<FrameSlots> s, int i) : slots(std::move(s)), index(i) {}
  template <typename U>
  SlotAllocator(const SlotAllocator<U>& other)  // NOLINT(google-explicit-constructor)
      : slots(other.slots), index(other.index) {}

  T* allocate(std::size_t count) {
    auto& control = slots->slots[static_cast<std::size_t>(index)]->control;
    if (count * sizeof(T) > control.size()) throw std::bad_alloc();
    return reinterpret_cast<T*>(control.data());
  }
  void deallocate(T*, std::size_t) { slots->give_back(index); }
  template <typename U>
  bool operator==(const SlotAllocator<U>& other) const {
    return slots == other.slots && index == other.index;
  }
};

struct NoDelete {
  void operator()(const Frame*) const {}
};

}  // namespace

FramePool::FramePool(int buffers, std::size_t bytes, std::size_t amplitude_bytes,
                     std::size_t confidence_bytes)
    : slots_(std::make_shared<FrameSlots>()) {
  slots_->free.reserve(static_cast<std::size_t>(buffers));
  for (int i = 0; i < buffers; ++i) {
    auto slot = std::make_unique<FrameSlots::Slot>();
    slot->bytes.resize(bytes);
    slot->amplitude.resize(amplitude_bytes);
    slot->confidence.resize(confidence_bytes);
    slots_->slots.push_back(std::move(slot));
    slots_->free.push_back(i);
  }
}

FramePool::Draft FramePool::take() {
  Draft draft;
  const std::lock_guard lock(slots_->mutex);
  if (slots_->free.empty()) return draft;
  draft.index_ = slots_->free.back();
  slots_->free.pop_back();
  auto& slot = *slots_->slots[static_cast<std::size_t>(draft.index_)];
  draft.slots_ = slots_;
  draft.frame_ = &slot.frame;
  draft.bytes_ = slot.bytes;
  draft.amplitude_ = slot.amplitude;
  draft.confidence_ = slot.confidence;
  return draft;
}

int FramePool::free() const {
  const std::lock_guard lock(slots_->mutex);
  return static_cast<int>(slots_->free.size());
}

FramePool::Draft::Draft(Draft&& other) noexcept { *this = std::move(other); }

FramePool::Draft& FramePool::Draft::operator=(Draft&& other) noexcept {
  std::swap(slots_, other.slots_);
  std::swap(frame_, other.frame_);
  std::swap(index_, other.index_);
  std::swap(bytes_, other.bytes_);
  std::swap(amplitude_, other.amplitude_);
  std::swap(confidence_, other.confidence_);
  return *this;
}

FramePool::Draft::~Draft() {
  if (slots_ && index_ >= 0) slots_->give_back(index_);
}

FramePtr FramePool::Draft::publish(Frame frame, std::size_t used, std::size_t amplitude_used,
                                   std::size_t confidence_used) && {
  const auto first = [](std::span<const std::uint8_t> of, std::size_t count) {
    return of.first(std::min(count, of.size()));
  };
  frame.bytes = first(bytes_, used);
  frame.amplitude = first(amplitude_, amplitude_used);
  frame.confidence = first(confidence_, confidence_used);
  frame.memory = {};  // the bytes lie in this pool
  *frame_ = frame;
  const int index = std::exchange(index_, -1);
  return {frame_, NoDelete{}, SlotAllocator<std::byte>(slots_, index)};
}

}  // namespace mixrig::device
