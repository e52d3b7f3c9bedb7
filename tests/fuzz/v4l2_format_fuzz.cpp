// SPDX-License-Identifier: Apache-2.0
// Mode tables and layouts of any numbers: the chosen mode has a valid size and format, and a layout
// is never smaller than its picture. Buffers of any length become frames without a read or write
// beyond either end (AddressSanitizer checks it).
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "hal/wire/camera/v4l2_format.h"
#include "tests/fuzz/target.h"

namespace {

/// Reads numbers from the input; after its end it returns zeros.
class Numbers {
 public:
  Numbers(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  template <typename T>
  T next() {
    T value{};
    if (left_ < sizeof value) return left_ = 0, value;
    std::memcpy(&value, data_, sizeof value);
    data_ += sizeof value;
    left_ -= sizeof value;
    return value;
  }
  bool empty() const { return left_ == 0; }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

}  // namespace

MIXRIG_FUZZ_TARGET(v4l2_format) {
  using namespace mixrig;
  using namespace mixrig::device;
  constexpr std::uint32_t kCodes[] = {fourcc('Y', 'U', 'Y', 'V'),
                                      fourcc('N', 'V', '1', '2'),
                                      fourcc('M', 'J', 'P', 'G'),
                                      fourcc('Z', '1', '6', ' '),
                                      fourcc('G', 'R', 'E', 'Y'),
                                      fourcc('N', 'M', '1', '2'),
                                      fourcc('p', 'R', 'A', 'A'),
                                      fourcc('p', 'B', 'C', 'C'),
                                      fourcc('Y', '1', '0', 'B'),
                                      fourcc('R', 'G', '1', '2'),
                                      0};
  Numbers in(data, size);
  const auto code = [&] { return kCodes[in.next<std::uint8_t>() % std::size(kCodes)]; };
  const auto side = [&] { return Size{in.next<std::int32_t>(), in.next<std::int32_t>()}; };
  const StreamRequest request{
      .size = {in.next<std::int16_t>(), in.next<std::int16_t>()},
      .format = static_cast<PixelFormat>(in.next<std::uint8_t>() % kPixelFormats),
      .rate_hz = in.next<float>()};
  const auto small = in.next<std::uint8_t>() < 128;
  const auto extent = [&] {
    return small ? in.next<std::uint8_t>() % 40U : in.next<std::uint32_t>();
  };
  const std::uint32_t layout_code = code(), width = extent(), height = extent();
  const auto number = [&] {
    return small ? in.next<std::uint16_t>() % 4096U : in.next<std::uint32_t>();
  };
  const V4l2Plane planes[] = {{number() % 128, number()}, {number() % 128, number()}};
  const auto layout = checked_layout(layout_code, width, height,
                                     std::span(planes).first(layout_code == kCodes[5] ? 2 : 1));
  (void)encoding_of({in.next<std::uint8_t>(), in.next<std::uint8_t>(), in.next<std::uint8_t>(),
                     in.next<std::uint8_t>()});
  if (layout) {
    if (layout->size.empty() || layout->format == PixelFormat::kUnknown) std::abort();
    if (image_bytes(layout->format, layout->size, layout->stride_bytes) > layout->picture_bytes)
      std::abort();
    const std::vector<std::uint8_t> first(in.next<std::uint16_t>()),
        second(in.next<std::uint16_t>() % 4096);
    const V4l2Bytes bytes{first, second};
    if (layout->picture_bytes < 1 << 20) {
      std::vector<std::uint8_t> out(layout->picture_bytes);
      const std::size_t used = copy_v4l2_picture(*layout, bytes, out);
      if (used > out.size()) std::abort();
      if (payload_flags(*layout, bytes, false) == kFrameOk && layout->stride_bytes > 0 &&
          used != out.size())
        std::abort();
    }
  }
  std::vector<V4l2Mode> modes;
  while (!in.empty() && modes.size() < 64)
    modes.push_back({code(), side(), side(), side(), in.next<float>()});
  const auto choice = choose_mode(modes, request);
  if (choice && (choice->size.empty() || choice->format == PixelFormat::kUnknown)) std::abort();
  return 0;
}
