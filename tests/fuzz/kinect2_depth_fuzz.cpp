// SPDX-License-Identifier: Apache-2.0
// Isochronous packets of a Kinect v2 in any order and length. Two bytes of the input make one
// packet; the end of a picture is its footer, whose frame and picture number also come from the
// input.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "hal/wire/camera/kinect2_raw.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(kinect2_depth) {
  using namespace mixrig::device;
  static Kinect2DepthStream stream;
  static std::vector<std::uint8_t> bytes(kKinect2PacketBytes + 1, 0x5A);
  stream.restart();
  std::uint64_t frames = 0;
  const Kinect2RawSink sink = [&](const Kinect2RawFrame& frame) {
    if (frame.pictures.size() != kKinect2RawBytes) std::abort();
    frames += frame.whole ? 1 : 0;
  };
  std::size_t packets = 0;
  for (std::size_t i = 0; i + 1 < size && packets < 40; i += 2, ++packets) {
    const std::uint8_t kind = data[i], value = data[i + 1];
    const auto put = [&](std::size_t at, std::uint32_t v) {
      for (std::size_t b = 0; b < 4; ++b)
        bytes[kKinect2PictureBytes + at + b] = static_cast<std::uint8_t>(v >> (8 * b));
    };
    put(12, value / 16), put(16, value % 16), put(20, kind % 32 == 31 ? value : 298496);
    const std::span<const std::uint8_t> all(bytes);
    if (kind % 4 == 0)
      stream.feed(all.first(std::size_t{value} * 1171), kind % 16 != 12, sink);
    else if (kind % 4 == 1)
      stream.feed({}, true, sink);
    else
      stream.feed(all.first(kKinect2PacketBytes + (kind % 64 == 63 ? 1 : 0)), true, sink);
  }
  if (frames > packets / 10) std::abort();
  return 0;
}
