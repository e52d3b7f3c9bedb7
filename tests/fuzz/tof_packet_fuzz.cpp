// SPDX-License-Identifier: Apache-2.0
// Any bytes from a USB ToF camera, split anywhere. The first byte selects: a description, the
// stream unchanged, or the stream with correct checksums, so that the code behind them is reached.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "hal/wire/camera/tof_usb_decoder.h"
#include "tests/fuzz/target.h"

namespace {

using namespace mixrig::device;

void correct_checksums(std::vector<std::uint8_t>& bytes) {
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  };
  for (std::size_t at = 0; at + kTofHeaderBytes <= bytes.size();) {
    put(at, 0x4D544F50);
    std::uint32_t payload = 0;
    std::memcpy(&payload, bytes.data() + at + 20, 4);
    const std::size_t left = bytes.size() - at - kTofHeaderBytes;
    const std::size_t count = std::min<std::size_t>(payload, left);
    const std::span<const std::uint8_t> all(bytes);
    put(at + 32, tof_crc32(all.subspan(at + kTofHeaderBytes, count)));
    put(at + 36, tof_crc32(all.subspan(at, 36)));
    at += kTofHeaderBytes + count;
  }
}

}  // namespace

MIXRIG_FUZZ_TARGET(tof_packet) {
  if (size == 0) return 0;
  const std::uint8_t mode = *data;
  std::vector<std::uint8_t> bytes(data + 1, data + size);
  if (mode % 4 == 0) {
    const auto description = parse_tof_description(bytes);
    if (description && (description->size.empty() || !(description->depth.metres_per_step > 0)))
      std::abort();
    return 0;
  }
  if (mode % 4 == 1) correct_checksums(bytes);
  TofDescription description;
  description.size = {16, 12};
  description.amplitude = (mode & 4) != 0;
  const std::size_t whole = description.size.area() * 2;
  FramePool pool(3, whole, whole);
  TofUsbDecoder decoder(description, pool);
  std::uint64_t frames = 0;
  const FrameSink sink = [&](const FramePtr& frame) {
    if (frame->bytes.size() != whole) std::abort();
    ++frames;
  };
  const std::size_t step = 1 + mode;
  for (std::size_t at = 0; at < bytes.size(); at += step)
    decoder.feed(std::span(bytes).subspan(at, std::min(step, bytes.size() - at)), {}, sink);
  if (decoder.health().frames != frames) std::abort();
  return 0;
}
