// SPDX-License-Identifier: Apache-2.0
// The mapped buffers of one V4L2 stream, exported as DMABUFs where the driver allows it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "hal/base/raw_picture.h"
#include "hal/device/frame.h"
#include "hal/wire/camera/v4l2_format.h"

namespace mixrig::device {

/// Buffers that a node and the frames lent from it own together. Mappings end and descriptors are
/// closed with the last owner; a mapping outlives its node and the device. The thread that starts
/// the stream calls add() and export_as(); any thread may call the others.
class V4l2Buffers {
 public:
  struct Mapping {
    void* address = nullptr;
    std::size_t bytes = 0;
  };
  using Planes = std::array<Mapping, kMostV4l2Planes>;

  V4l2Buffers();
  ~V4l2Buffers();
  V4l2Buffers(const V4l2Buffers&) = delete;
  V4l2Buffers& operator=(const V4l2Buffers&) = delete;

  /// Adds a buffer without planes.
  Planes& add();
  /// Takes ownership of the descriptor that the first plane of the last buffer was exported as.
  void export_as(int fd) { fds_.back() = fd; }
  std::size_t count() const { return planes_.size(); }
  const Planes& planes(std::uint32_t index) const { return planes_[index]; }
  /// Returns the shared memory of a picture that begins `offset_bytes` into its buffer; empty if
  /// the buffer is not exported.
  DmaBuf memory(std::uint32_t index, std::size_t offset_bytes) const;

  /// Lends a buffer that the driver has filled. Returns false if it is not exported, or if fewer
  /// than `kept` buffers would stay with the driver.
  bool lend(std::uint32_t index, std::size_t kept);
  /// Returns a lent buffer; its last user calls it.
  void give_back(std::uint32_t index);
  /// Appends the buffers returned since the last call to `indices`, whose capacity must suffice for
  /// all buffers.
  void collect(std::vector<std::uint32_t>& indices);

 private:
  const std::uint64_t set_;  ///< DmaBuf::set
  std::vector<Planes> planes_;
  std::vector<int> fds_;
  std::mutex mutex_;  ///< guards lent_ and returned_
  std::size_t lent_ = 0;
  std::vector<std::uint32_t> returned_;
};

/// A frame whose bytes lie in a lent buffer; for a Pool.
struct LentPicture {
  Frame frame{};
  std::shared_ptr<V4l2Buffers> buffers{};
  std::uint32_t index = 0;
  /// Returns the buffer; Pool calls it when the last user drops the frame.
  void recycle();
};

}  // namespace mixrig::device
