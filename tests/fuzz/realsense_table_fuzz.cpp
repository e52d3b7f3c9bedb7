// SPDX-License-Identifier: Apache-2.0
// An answer of a RealSense camera: an accepted one is a pinhole inside the picture. If the first
// byte is even, the CRC is corrected, so that the code behind the check is reached.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <zlib.h>

#include "hal/wire/camera/realsense_table.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(realsense_table) {
  using namespace mixrig;
  if (size < 2) return 0;
  constexpr Size kSizes[] = {{848, 480}, {640, 400}, {1920, 1080}, {100, 100}, {0, -1}};
  const Size picture = kSizes[data[1] % std::size(kSizes)];
  std::vector<std::uint8_t> answer(data + 2, data + size);
  if (data[0] % 2 == 0) {
    answer.resize(device::kRealSenseMonitorBytes);
    const std::uint8_t head[] = {0x15, 0, 0, 0, 2, 0, 25, 0};
    std::copy(std::begin(head), std::end(head), answer.begin());
    const auto bytes = answer[8] | (answer[9] & 3U) << 8;
    const auto most = std::min<std::size_t>(bytes, answer.size() - 24);
    const auto crc = ::crc32(0, answer.data() + 20, static_cast<unsigned>(most));
    for (int i = 0; i < 4; ++i)
      answer[16 + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(crc >> 8 * i);
  }
  const auto k = device::parse_realsense_calibration(answer, picture);
  if (k && !(k->focal_px > 0 && k->principal_x_px > 0 && k->principal_x_px < picture.width &&
             k->principal_y_px > 0 && k->principal_y_px < picture.height))
    std::abort();
  return 0;
}
