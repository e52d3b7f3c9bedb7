// SPDX-License-Identifier: Apache-2.0
// What was shown when: the raw data of a measured delay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/image.h"

namespace mixrig::output {

struct ShownFrame {
  int number = 0;                ///< of the capture
  HostTime exposed{};            ///< as the system says
  HostTime handed{};             ///< composite finished and given to the sink
  HostTime shown{};              ///< given to the screen, or taken by a sink without one
  float frame_ms = 0;            ///< to composite it
  std::optional<double> column;  ///< measure::changed_column of what was shown
};

/// Filled by one sink, read when that has finished; what has no room is left out.
struct ShownLog {
  Image<Rgb8> empty;             ///< the view without what moves
  Image<std::uint8_t> left_out;  ///< not 0: pixels that do not count; may be empty
  std::vector<ShownFrame> frames;

  void reserve(std::size_t frames_to_come) { frames.reserve(frames_to_come); }
  void add(const ShownFrame& frame) {
    if (frames.size() < frames.capacity()) frames.push_back(frame);
  }
};

}  // namespace mixrig::output
