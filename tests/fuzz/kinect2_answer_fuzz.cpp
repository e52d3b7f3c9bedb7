// SPDX-License-Identifier: Apache-2.0
// Any bytes as a Kinect v2's answers to commands. The first byte selects the answer. The table of
// phase offsets is longer than the inputs; their bytes are repeated to fill it.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "extras/kinect2/kinect2_protocol.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(kinect2_answer) {
  using namespace mixrig::device;
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  switch (*data % 6) {
    case 0:
      if (const auto serial = parse_kinect2_serial(bytes); serial && serial->empty()) std::abort();
      break;
    case 1:
      (void)parse_kinect2_firmware(bytes), (void)parse_kinect2_status(bytes);
      (void)parse_kinect2_complete(bytes);
      break;
    case 2:
      if (const auto lens = parse_kinect2_infrared(bytes); lens && !std::isfinite(lens->fx_px))
        std::abort();
      break;
    case 3:
      if (const auto lens = parse_kinect2_color(bytes); lens && !std::isfinite(lens->f_px))
        std::abort();
      break;
    case 4:
      if (const auto footer = parse_kinect2_footer(bytes); footer && footer->picture > 9)
        std::abort();
      break;
    default: {
      if (size < 2 || size % 16 != 1) break;  // 1.3 MB
      std::vector<std::uint8_t> table(1302570 + size % 5);
      for (std::size_t i = 0; i < table.size(); ++i) table[i] = bytes[i % bytes.size()];
      if (parse_kinect2_offsets(table).has_value() != (table.size() >= 1302572)) std::abort();
    }
  }
  return 0;
}
