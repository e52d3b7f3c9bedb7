// SPDX-License-Identifier: Apache-2.0
// A range of frames of a recording.
#pragma once

#include <utility>

namespace mixrig {

/// Frame numbers, 1-based and inclusive.
using FrameRange = std::pair<int, int>;

}  // namespace mixrig
