// SPDX-License-Identifier: Apache-2.0
// Mode tables and layouts of any numbers: the chosen mode has a valid size and format, and a layout
// is never smaller than its picture.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "hal/wire/v4l2_format.h"
#include "tests/fuzz/target.h"

namespace {

/// Reads numbers from the input; zeros after its end.
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
  constexpr std::uint32_t kCodes[] = {fourcc('Y', 'U', 'Y', 'V'), fourcc('N', 'V', '1', '2'),
                                      fourcc('M', 'J', 'P', 'G'), fourcc('Z', '1', '6', ' '),
                                      fourcc('G', 'R', 'E', 'Y'), 0};
  Numbers in(data, size);
  const auto code = [&] { return kCodes[in.next<std::uint8_t>() % std::size(kCodes)]; };
  const auto side = [&] { return Size{in.next<std::int32_t>(), in.next<std::int32_t>()}; };
  const StreamRequest request{
      .size = {in.next<std::int16_t>(), in.next<std::int16_t>()},
      .format = static_cast<PixelFormat>(in.next<std::uint8_t>() % kPixelFormats),
      .rate_hz = in.next<float>()};
  const auto layout = checked_layout(code(), in.next<std::uint32_t>(), in.next<std::uint32_t>(),
                                     in.next<std::uint32_t>(), in.next<std::uint32_t>());
  if (layout) {
    if (layout->size.empty() || layout->format == PixelFormat::kUnknown) std::abort();
    if (image_bytes(layout->format, layout->size, layout->stride_bytes) > layout->picture_bytes)
      std::abort();
    (void)payload_flags(*layout, in.next<std::uint32_t>(), false);
  }
  std::vector<V4l2Mode> modes;
  while (!in.empty() && modes.size() < 64)
    modes.push_back({code(), side(), side(), side(), in.next<float>()});
  const auto choice = choose_mode(modes, request);
  if (choice && (choice->size.empty() || choice->format == PixelFormat::kUnknown)) std::abort();
  return 0;
}
