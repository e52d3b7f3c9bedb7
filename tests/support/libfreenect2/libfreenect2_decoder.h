// SPDX-License-Identifier: Apache-2.0
// libfreenect2's CPU decoder with its default filters, as an independent one.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "hal/base/image.h"

namespace mixrig::test {

/// Range 0.3 to 9 m. Its tables of x and z are computed for the rows that it writes: its own
/// program computes them for the rows as they are sent, upside down, which moves z by what the lens
/// is off the middle. One thread.
class Libfreenect2Decoder {
 public:
  /// The device's answers to the requests for its phase offsets and its infrared lens, valid ones.
  Libfreenect2Decoder(std::span<const std::uint8_t> phase_offsets,
                      std::span<const std::uint8_t> infrared);
  ~Libfreenect2Decoder();

  /// `raw`: ten pictures, each with its footer, as the device sends them; they go through its
  /// stream parser. Distances along the ray, metres, as one sees them (x to the right), 0 unknown;
  /// empty where the parser gave no frame.
  const Image<float>& decode(std::span<const std::uint8_t> raw);
  /// Processor time of the decoder alone in the last call.
  double cpu_s() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mixrig::test
