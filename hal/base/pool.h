// SPDX-License-Identifier: Apache-2.0
// Objects that threads share; the pool reuses one when its last user drops it.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace mixrig {

/// Hands out objects and keeps their buffers between uses: it allocates only while more objects are
/// in use than exist. T::recycle(), if there is one, is called when the last user drops an object.
/// Any threads; objects may outlive the pool.
template <typename T>
class Pool {
 public:
  /// Returns an object that nobody else holds. It still has the content of its last use.
  std::shared_ptr<T> take() {
    Slot* slot = slots_->take();
    return std::shared_ptr<T>(&slot->value, NoDelete{}, SlotAllocator<T>(slots_, slot));
  }
  /// Number of objects made so far, which is the largest number in use at one time.
  std::size_t size() const { return slots_->size(); }

 private:
  struct Slot {
    T value{};
    /// Holds the shared_ptr's control block, so that handing out does not allocate.
    alignas(std::max_align_t) std::array<std::byte, 128> control;
  };
  class Slots {
   public:
    Slot* take() {
      const std::lock_guard lock(mutex_);
      if (free_.empty()) {
        all_.push_back(std::make_unique<Slot>());
        free_.reserve(all_.size());
        return all_.back().get();
      }
      Slot* slot = free_.back();
      free_.pop_back();
      return slot;
    }
    void give_back(Slot* slot) {
      if constexpr (requires { slot->value.recycle(); }) slot->value.recycle();
      const std::lock_guard lock(mutex_);
      free_.push_back(slot);  // capacity was reserved
    }
    std::size_t size() const {
      const std::lock_guard lock(mutex_);
      return all_.size();
    }

   private:
    mutable std::mutex mutex_;
    std::vector<std::unique_ptr<Slot>> all_;
    std::vector<Slot*> free_;
  };

  struct NoDelete {
    void operator()(const T*) const {}
  };
  /// Places the control block in the slot. The slot becomes free when that block is deallocated,
  /// which is after the last reference is gone.
  template <typename U>
  struct SlotAllocator {
    using value_type = U;
    std::shared_ptr<Slots> slots;
    Slot* slot;

    SlotAllocator(std::shared_ptr<Slots> all, Slot* one) : slots(std::move(all)), slot(one) {}
    template <typename V>
    SlotAllocator(const SlotAllocator<V>& other)  // NOLINT(google-explicit-constructor)
        : slots(other.slots), slot(other.slot) {}
    U* allocate(std::size_t count) {
      if (count * sizeof(U) > slot->control.size()) throw std::bad_alloc();
      return reinterpret_cast<U*>(slot->control.data());
    }
    void deallocate(U*, std::size_t) { slots->give_back(slot); }
    template <typename V>
    bool operator==(const SlotAllocator<V>& other) const {
      return slot == other.slot;
    }
  };

  std::shared_ptr<Slots> slots_ = std::make_shared<Slots>();
};

}  // namespace mixrig
