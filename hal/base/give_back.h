// SPDX-License-Identifier: Apache-2.0
// Pages of an image that are not used yet.
#pragma once

#include <cstddef>

#include "hal/base/image.h"

namespace mixrig {

/// Makes `bytes` bytes at `memory` zero, which private memory must be (malloc's is), and gives the
/// whole pages in it back to the system: each takes memory again when it is first written. To be
/// called before the memory is used, not in each frame: every page costs a fault later.
void give_back_as_zeros(void* memory, std::size_t bytes);

/// Makes an image zero without using memory for it: what is never written costs none.
template <typename T>
void give_back_as_zeros(Image<T>& image) {
  if (image.empty()) return;
  give_back_as_zeros(image.row(0), static_cast<std::size_t>(image.stride()) *
                                       static_cast<std::size_t>(image.height()) * sizeof(T));
}

}  // namespace mixrig
