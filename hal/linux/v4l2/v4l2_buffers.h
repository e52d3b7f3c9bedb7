// SPDX-License-Identifier: Apache-2.0
// The buffers of one V4L2 stream, mapped, and exported as DMABUFs where the driver does that.
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

/// Belongs to the node and to the frames that are lent from it: mappings end, and descriptors are
/// closed, with the last of them; a mapping outlives its node and the device. add() and export_as()
/// are for the thread that starts the stream, the others for any.
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

  /// A further buffer without planes.
  Planes& add();
  /// Takes the descriptor that the first plane of the last buffer was exported as.
  void export_as(int fd) { fds_.back() = fd; }
  std::size_t count() const { return planes_.size(); }
  const Planes& planes(std::uint32_t index) const { return planes_[index]; }
  /// Of a picture that begins so many bytes into its buffer; none where that is not exported.
  DmaBuf memory(std::uint32_t index, std::size_t offset_bytes) const;

  /// Lends a buffer that the driver has filled, unless fewer than `kept` would stay with the
  /// driver.
  bool lend(std::uint32_t index, std::size_t kept);
  /// From the last user of a lent one.
  void give_back(std::uint32_t index);
  /// Appends those that were given back since the last call to `indices`, which has room for all.
  void collect(std::vector<std::uint32_t>& indices);

 private:
  const std::uint64_t set_;  ///< DmaBuf::set
  std::vector<Planes> planes_;
  std::vector<int> fds_;
  std::mutex mutex_;  ///< guards what follows
  std::size_t lent_ = 0;
  std::vector<std::uint32_t> returned_;
};

/// A frame whose bytes lie in such a buffer; for a Pool.
struct LentPicture {
  Frame frame{};
  std::shared_ptr<V4l2Buffers> buffers{};
  std::uint32_t index = 0;
  /// The last user is done.
  void recycle();
};

}  // namespace mixrig::device
