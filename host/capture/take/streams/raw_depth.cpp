// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/streams/raw_depth.h"

#include <algorithm>
#include <utility>

#include "host/capture/take/streams/picture_files.h"
#include "host/math/config/table.h"

namespace mixrig::take {
namespace {

constexpr std::size_t kMostRawBytes = std::size_t{8} << 20;

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Error in_file(const std::filesystem::path& path, const std::string& what) {
  return Error{ErrorCode::kData, "'" + path.string() + "': " + what};
}

}  // namespace

Result<RawDepth> RawDepth::open(const std::filesystem::path& root, const StreamInfo& stream) {
  MIXRIG_ASSIGN(const NumberedName name, NumberedName::parse(stream.path));
  const std::filesystem::path folder = (root / stream.path).parent_path();
  MIXRIG_ASSIGN(const std::string offsets_text,
                config::read_text(folder / kRawOffsets, kMostRawBytes));
  MIXRIG_ASSIGN(const std::string infrared_text,
                config::read_text(folder / kRawInfrared, kMostRawBytes));
  const auto offsets = device::parse_kinect2_offsets(bytes_of(offsets_text));
  if (!offsets) return in_file(folder / kRawOffsets, "not the phase offsets of a Kinect v2");
  const auto infrared = device::parse_kinect2_infrared(bytes_of(infrared_text));
  if (!infrared) return in_file(folder / kRawInfrared, "not the parameters of a Kinect v2");
  RawDepth raw(depth::kinect2_phase_camera(*infrared, *offsets));
  raw.path_of_ = [root, name, first = stream.first](int index) {
    return root / name.with(first + index);
  };
  return raw;
}

Result<void> RawDepth::read(int index, Image<float>& distance_m, Image<float>& amplitude) {
  const std::filesystem::path path = path_of_(index);
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMostRawBytes));
  std::span<const std::uint8_t> rest = bytes_of(text);
  bool whole = false;
  packets_.restart();
  while (!rest.empty()) {
    const auto packet = rest.first(std::min(rest.size(), device::kKinect2PacketBytes));
    rest = rest.subspan(packet.size());
    packets_.feed(packet, true, [&](const device::Kinect2RawFrame& frame) {
      whole = frame.whole;
      if (whole) decoder_->decode(frame.pictures, decoded_);
    });
  }
  if (!whole) return in_file(path, "not one whole raw frame: copy the take again");
  if (distance_m.size() != decoded_.distance_m.size()) distance_m.reset(decoded_.distance_m.size());
  for (int y = 0; y < distance_m.height(); ++y)
    for (int x = 0; x < distance_m.width(); ++x)
      distance_m.row(y)[x] = decoded_.state.row(y)[x] == depth::PixelState::kGood
                                 ? decoded_.distance_m.row(y)[x]
                                 : 0.0F;
  amplitude = decoded_.amplitude;
  return {};
}

}  // namespace mixrig::take
