// SPDX-License-Identifier: Apache-2.0
// Any bytes as a ROS 1 bag and its messages, as the contents of a Matroska file, as the calibration
// in it, and as matrices.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "host/capture/take/foreign/azure_calibration.h"
#include "host/capture/take/foreign/ros_messages.h"
#include "host/capture/take/foreign/ros_records.h"
#include "host/capture/take/streams/matroska_tracks.h"
#include "host/capture/take/tum_folder.h"
#include "tests/fuzz/target.h"

namespace {

void parse_message(std::span<const std::uint8_t> bytes) {
  using namespace mixrig;
  static_cast<void>(take::parse_camera_info(bytes));
  static_cast<void>(take::parse_transforms(bytes));
  constexpr std::size_t kMostPixels = std::size_t{1} << 20;
  for (const bool is_compressed : {false, true}) {
    const auto picture = take::parse_picture(bytes, is_compressed);
    if (!picture || picture->size_px.area() > kMostPixels) continue;
    Image<Rgb8> color;
    Image<std::uint16_t> steps;
    if (take::decode_color(*picture, color) && color.size() != picture->size_px) std::abort();
    if (take::decode_depth(*picture, 0.001, steps) && steps.size() != picture->size_px)
      std::abort();
  }
}

}  // namespace

MIXRIG_FUZZ_TARGET(foreign) {
  using namespace mixrig;
  const std::span<const std::uint8_t> bytes(data, size);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  parse_message(bytes);
  static_cast<void>(take::each_message(bytes, [](const take::BagMessage& message) -> Result<void> {
    parse_message(message.bytes);
    return {};
  }));
  const take::MatroskaContents contents = take::parse_contents(bytes);
  for (const take::MatroskaBlock& block : contents.blocks)
    if (!block.bytes.empty() &&
        (block.bytes.data() < data || block.bytes.data() + block.bytes.size() > data + size))
      std::abort();
  static_cast<void>(take::parse_azure_calibration(text, {1280, 720}, {640, 576}));
  static_cast<void>(take::parse_numbers(text));
  return 0;
}
