// SPDX-License-Identifier: Apache-2.0
// Log of shown frames: the raw data for measuring a delay.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/image.h"

namespace mixrig::output {

struct ShownFrame {
  int number = 0;                ///< number of the capture
  HostTime exposed{};            ///< time of exposure by the system's own stamps
  HostTime handed{};             ///< the finished composite was given to the sink
  HostTime shown{};              ///< given to the screen, or taken by a sink without a screen
  float frame_ms = 0;            ///< time to composite it
  std::optional<double> column;  ///< measure::changed_column of the shown picture
};

/// Filled by one sink, and read after it has finished; frames beyond the reserved number are
/// dropped.
struct ShownLog {
  Image<Rgb8> empty;             ///< the view without moving things
  Image<std::uint8_t> left_out;  ///< nonzero: pixels to ignore; may be empty
  std::vector<ShownFrame> frames;

  void reserve(std::size_t frames_to_come) { frames.reserve(frames_to_come); }
  void add(const ShownFrame& frame) {
    if (frames.size() < frames.capacity()) frames.push_back(frame);
  }
};

}  // namespace mixrig::output
