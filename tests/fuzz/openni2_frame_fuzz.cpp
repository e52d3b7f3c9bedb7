// SPDX-License-Identifier: Apache-2.0
// A frame of OpenNI2, whose .oni files may say anything of size, stride and length: nothing is read
// or written beyond either end (AddressSanitizer checks it).
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "extras/openni2/openni2_stream.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(openni2_frame) {
  using namespace mixrig;
  using device::PixelFormat;
  constexpr std::size_t kHead = 12;
  if (size < kHead) return 0;
  constexpr PixelFormat kFormats[] = {PixelFormat::kDepth16, PixelFormat::kRgb8, PixelFormat::kYuyv,
                                      PixelFormat::kGray8, PixelFormat::kGray16};
  device::OpenNi2Mode mode{.format = kFormats[data[0] % 5], .mirrored = data[0] >= 128};
  mode.mirrored = mode.mirrored && mode.format != PixelFormat::kYuyv;  // refused before
  mode.mode.resolutionX = data[1] % 32 + 1, mode.mode.resolutionY = data[2] % 32 + 1;
  // The bytes lie in memory of their own size, as the library's do.
  std::vector<std::uint8_t> bytes(data + kHead, data + size);
  OniFrame frame{};
  frame.data = data[3] == 0 ? nullptr : bytes.data();
  frame.dataSize =
      data[4] % 4 == 0 ? static_cast<std::int8_t>(data[5]) : static_cast<int>(bytes.size());
  if (frame.dataSize > static_cast<int>(bytes.size()))
    frame.dataSize = static_cast<int>(bytes.size());
  frame.width = data[4] & 16 ? static_cast<std::int8_t>(data[6]) : mode.mode.resolutionX;
  frame.height = data[4] & 32 ? static_cast<std::int8_t>(data[7]) : mode.mode.resolutionY;
  std::memcpy(&frame.stride, data + 8, sizeof frame.stride);
  if (data[4] & 64)
    frame.stride =
        static_cast<int>(device::row_bytes(mode.format, mode.mode.resolutionX)) + data[8] % 3;
  frame.croppingEnabled = data[4] >= 128;
  const std::size_t whole = device::row_bytes(mode.format, mode.mode.resolutionX) *
                            static_cast<std::size_t>(mode.mode.resolutionY);
  std::vector<std::uint8_t> out(data[3] == 1 ? whole / 2 : whole);
  const bool copied = device::copy_openni2(frame, mode, out);
  if (copied && (frame.data == nullptr || out.size() < whole)) std::abort();
  return 0;
}
