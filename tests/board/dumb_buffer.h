// SPDX-License-Identifier: Apache-2.0
// Memory of a DRM device that GL draws from: what a camera of an embedded board would fill.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hal/base/image.h"

namespace mixrig::board {

/// A dumb buffer, mapped, and exported as a DMABUF. Released at the end, the descriptor with it.
class DumbBuffer {
 public:
  /// `size`: bytes a row, rows. Null where `driver` ("vgem") has no node or refuses.
  static std::unique_ptr<DumbBuffer> make(const std::string& driver, Size size);
  ~DumbBuffer();
  DumbBuffer(const DumbBuffer&) = delete;
  DumbBuffer& operator=(const DumbBuffer&) = delete;

  int fd() const { return exported_; }
  std::size_t stride_bytes() const { return stride_bytes_; }
  std::span<std::uint8_t> bytes() const { return bytes_; }

 private:
  DumbBuffer() = default;
  bool create(Size size);

  int node_ = -1, exported_ = -1;
  std::uint32_t handle_ = 0;
  std::size_t stride_bytes_ = 0;
  std::span<std::uint8_t> bytes_;
};

}  // namespace mixrig::board
