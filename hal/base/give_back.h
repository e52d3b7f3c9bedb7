// SPDX-License-Identifier: Apache-2.0
// Zeroed memory that uses no pages until it is written.
#pragma once

#include <cstddef>

#include "hal/base/image.h"

namespace mixrig {

/// Zeroes `bytes` bytes at `memory`, which must be private memory such as malloc's, and returns the
/// whole pages in it to the system. A page uses memory again once it is written, at the cost of a
/// page fault: call this before the memory is used, not in each frame.
void give_back_as_zeros(void* memory, std::size_t bytes);

/// Zeroes an image; its pages use no memory until they are written.
template <typename T>
void give_back_as_zeros(Image<T>& image) {
  if (image.empty()) return;
  give_back_as_zeros(image.row(0), static_cast<std::size_t>(image.stride()) *
                                       static_cast<std::size_t>(image.height()) * sizeof(T));
}

}  // namespace mixrig
