// SPDX-License-Identifier: Apache-2.0
// A fixed set of frame buffers: publishing and dropping frames allocates nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "hal/device/frame.h"

namespace mixrig::device {

/// Buffers of one driver. `take` is for the driver's thread; frames may be dropped on any thread,
/// also after the pool itself is gone.
class FramePool {
 public:
  /// Makes `buffers` frames; each holds at most so many bytes of picture, amplitude and confidence.
  FramePool(int buffers, std::size_t bytes, std::size_t amplitude_bytes = 0,
            std::size_t confidence_bytes = 0);

  /// A buffer that is being filled. Publish it, or destroy it to return the buffer.
  class Draft {
   public:
    Draft() = default;
    Draft(Draft&& other) noexcept;
    Draft& operator=(Draft&& other) noexcept;
    ~Draft();

    explicit operator bool() const { return frame_ != nullptr; }
    std::span<std::uint8_t> bytes() const { return bytes_; }
    std::span<std::uint8_t> amplitude() const { return amplitude_; }
    std::span<std::uint8_t> confidence() const { return confidence_; }
    /// Publishes the frame as immutable. `frame.bytes`, `frame.amplitude` and `frame.confidence`
    /// are set to the used bytes at the start of this buffer; the counts are clipped to what it
    /// holds.
    FramePtr publish(Frame frame, std::size_t used, std::size_t amplitude_used = 0,
                     std::size_t confidence_used = 0) &&;

   private:
    friend class FramePool;
    std::shared_ptr<struct FrameSlots> slots_;
    Frame* frame_ = nullptr;
    int index_ = -1;
    std::span<std::uint8_t> bytes_, amplitude_, confidence_;
  };

  /// Returns an empty Draft when every buffer is in use: drop the picture and count it.
  Draft take();
  int free() const;

 private:
  std::shared_ptr<struct FrameSlots> slots_;
};

}  // namespace mixrig::device
