// SPDX-License-Identifier: Apache-2.0
// libfreenect2's CPU decoder with its default filters, as an independent reference.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "hal/base/image.h"

namespace mixrig::test {

/// Decodes depth from 0.3 to 9 m in one thread. Its tables of x and z are computed for the rows
/// that it writes. libfreenect2's own program computes them for the rows as they are sent, upside
/// down; where the lens is off the middle, z is then wrong.
class Libfreenect2Decoder {
 public:
  /// Both are the device's answers to the requests for its phase offsets and its infrared lens, and
  /// must be valid.
  Libfreenect2Decoder(std::span<const std::uint8_t> phase_offsets,
                      std::span<const std::uint8_t> infrared);
  ~Libfreenect2Decoder();

  /// `raw`: ten pictures, each with its footer, as the device sends them; they go through the
  /// library's stream parser. Returns distances along the ray in metres, x to the right as one sees
  /// the scene, 0 where unknown; empty where the parser gave no frame.
  const Image<float>& decode(std::span<const std::uint8_t> raw);
  /// Processor time of the decoder alone in the last call.
  double cpu_s() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace mixrig::test
