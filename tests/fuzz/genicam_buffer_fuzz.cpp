// SPDX-License-Identifier: Apache-2.0
// A GenICam buffer whose format, geometry and length may contradict: nothing is read or written
// beyond either end (AddressSanitizer checks it).
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "hal/wire/genicam_buffer.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(genicam_buffer) {
  using namespace mixrig;
  constexpr std::uint32_t kCodes[] = {device::pfnc::kMono8,       device::pfnc::kMono16,
                                      device::pfnc::kRgb8,        device::pfnc::kBayerRg8,
                                      device::pfnc::kYuyv,        device::pfnc::kCoord3dC16,
                                      device::pfnc::kCoord3dAbc16};
  if (size < 7) return 0;
  std::uint32_t code = kCodes[data[0] % std::size(kCodes)];
  if (data[0] >= 128) std::memcpy(&code, data + 1, 4);
  const Size picture{static_cast<std::int8_t>(data[5]), static_cast<std::int8_t>(data[6])};
  const std::size_t bytes = device::declared_bytes(code, picture);
  if (picture.empty() && bytes != 0) std::abort();
  // Exactly what was declared may be written; sometimes there is less room than that.
  std::vector<std::uint8_t> out(data[1] % 4 == 0 ? bytes / 2 : bytes);
  const bool copied = device::copy_picture(code, picture, std::span(data, size).subspan(7), out);
  if (copied && bytes == 0) std::abort();
  return 0;
}
