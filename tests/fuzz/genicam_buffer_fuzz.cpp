// SPDX-License-Identifier: Apache-2.0
// A GenICam buffer whose format, geometry and length may contradict each other: nothing is read or
// written beyond either end (AddressSanitizer checks it).
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "hal/wire/camera/genicam_buffer.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(genicam_buffer) {
  using namespace mixrig;
  using device::PixelFormat;
  constexpr std::uint32_t kCodes[] = {
      device::pfnc::kMono8,         device::pfnc::kMono16,        device::pfnc::kRgb8,
      device::pfnc::kBayerRg8,      device::pfnc::kYuyv,          device::pfnc::kCoord3dC16,
      device::pfnc::kCoord3dAbc16,  device::pfnc::kCoord3dAbcy16, device::pfnc::kCoord3dC32f,
      device::pfnc::kCoord3dAbc32f, device::pfnc::kMono10p,       device::pfnc::kBayerRg12p,
      device::pfnc::kConfidence8,   device::pfnc::kConfidence16};
  if (size < 7) return 0;
  std::uint32_t code = kCodes[data[0] % std::size(kCodes)];
  if (data[0] >= 128) std::memcpy(&code, data + 1, 4);
  const Size picture{static_cast<std::int8_t>(data[5]), static_cast<std::int8_t>(data[6])};
  const std::size_t bytes = device::declared_bytes(code, picture);
  if (picture.empty() && bytes != 0) std::abort();
  // The destination has exactly the size of the picture, sometimes less.
  const PixelFormat format = device::format_of_pfnc(code);
  const std::size_t whole =
      device::image_bytes(format, picture, device::row_bytes(format, std::max(0, picture.width)));
  std::vector<std::uint8_t> out(data[1] % 4 == 0 ? whole / 2 : whole);
  const bool copied = device::copy_picture(code, picture, std::span(data, size).subspan(7), out);
  if (copied && bytes == 0) std::abort();
  // The same bytes are also given as two parts of a depth frame.
  const std::size_t map = picture.empty() ? 0 : 2 * picture.area();
  std::vector<std::uint8_t> depth(data[2] % 4 == 0 ? map / 2 : map), amplitude(map),
      confidence(map);
  const auto body = std::span(data, size).subspan(7);
  const device::GenicamPart parts[] = {{code, picture, body.first(body.size() / 2)},
                                       {kCodes[data[3] % std::size(kCodes)], picture, body}};
  const auto used =
      device::copy_depth(parts, picture, {.invalid = 1.0F}, {depth, amplitude, confidence});
  if (used.depth > depth.size() || used.amplitude > map || used.confidence > map) std::abort();
  return 0;
}
