// SPDX-License-Identifier: Apache-2.0
// The frames between submit() and collect(), shared by both back ends.
#pragma once

#include <array>

#include "hal/base/result.h"
#include "host/render/contract/compositor.h"

namespace mixrig::render {

/// A queue of frames, first in, first out. Slots are kept and their memory is reused; with one
/// frame in flight at a time it is always the same slot.
template <typename Slot>
class InFlight {
 public:
  int count() const { return count_; }
  /// Returns the slot of the next frame. Errors: kUsage for more than Compositor::kMostInFlight.
  Result<Slot*> push() {
    if (count_ == Compositor::kMostInFlight)
      return Error{ErrorCode::kUsage,
                   "compositor: two frames are in flight already: collect one first"};
    return &slots_[static_cast<std::size_t>((first_ + count_++) % Compositor::kMostInFlight)];
  }
  /// Undoes the last push(), whose frame failed.
  void drop_last() { --count_; }
  /// Returns the slot of the oldest frame; valid until the next push(). Errors: kUsage where there
  /// is none.
  Result<Slot*> pop() {
    if (count_ == 0)
      return Error{ErrorCode::kUsage, "compositor: no frame is in flight: submit one first"};
    Slot* const oldest = &slots_[static_cast<std::size_t>(first_)];
    first_ = --count_ == 0 ? 0 : (first_ + 1) % Compositor::kMostInFlight;
    return oldest;
  }
  std::array<Slot, Compositor::kMostInFlight>& slots() { return slots_; }

 private:
  std::array<Slot, Compositor::kMostInFlight> slots_{};
  int first_ = 0, count_ = 0;
};

}  // namespace mixrig::render
