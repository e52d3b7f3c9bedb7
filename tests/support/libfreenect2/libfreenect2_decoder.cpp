// SPDX-License-Identifier: Apache-2.0
#include "tests/support/libfreenect2/libfreenect2_decoder.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

#include <libfreenect2/depth_packet_processor.h>
#include <libfreenect2/depth_packet_stream_parser.h>

#include "hal/wire/camera/kinect2_raw.h"
#include "host/math/geometry/camera_model.h"

// The library defines this in a file that is not compiled here, since it needs the device.
libfreenect2::Freenect2Device::Config::Config()
    : MinDepth(0.3F), MaxDepth(9.0F), EnableBilateralFilter(true), EnableEdgeAwareFilter(true) {}

namespace mixrig::test {
namespace {

constexpr Size kSize = device::kKinect2Depth;
constexpr std::size_t kIsochronous_bytes = 33792;
constexpr std::size_t kFooterFrame = 12;  ///< where a footer has the frame's number

geometry::CameraModel lens_of(std::span<const std::uint8_t> infrared) {
  const auto told = device::parse_kinect2_infrared(infrared);
  const auto& [k1, k2, p1, p2, k3] = told->distortion;
  return {{kSize, told->fx_px, told->fy_px, told->cx_px, told->cy_px},
          geometry::Lens({k1, k2, p1, p2, k3, 0, 0, 0})};
}

/// Measures the processor time of the decoder.
class TimedDecoder final : public libfreenect2::CpuDepthPacketProcessor {
 public:
  double cpu_s = 0;
  void process(const libfreenect2::DepthPacket& packet) override {
    const std::clock_t begin = std::clock();
    CpuDepthPacketProcessor::process(packet);
    cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    libfreenect2::DepthPacket done = packet;
    releaseBuffer(done);  // the parser waits for one of its two buffers
  }
};

}  // namespace

struct Libfreenect2Decoder::Parts final : libfreenect2::FrameListener {
  geometry::CameraModel lens;
  TimedDecoder decoder;
  libfreenect2::DepthPacketStreamParser parser;
  Image<float> distance_m;

  explicit Parts(const geometry::CameraModel& camera) : lens(camera) {}

  void load_tables(std::span<const std::uint8_t> phase_offsets) {
    constexpr double kScaling = 8192, kRange_mm = 6250.0 / 3;  // constants of the library
    const auto area = static_cast<std::size_t>(kSize.area());
    std::vector<float> x_table(area), z_table(area);
    std::size_t i = 0;
    for (int y = kSize.height - 1; y >= 0; --y)
      for (int x = kSize.width - 1; x >= 0; --x, ++i)
        if (const auto ray = lens.unproject({x, y})) {
          x_table[i] = static_cast<float>(-kScaling * ray->x());
          z_table[i] = static_cast<float>(kRange_mm / std::sqrt(1 + ray->squaredNorm()));
        }
    decoder.loadXZTables(x_table.data(), z_table.data());
    std::vector<short> samples(libfreenect2::DepthPacketProcessor::LUT_SIZE);
    int value = 0;
    for (std::size_t code = 0; code < 1024; ++code) {
      samples[code] = static_cast<short>(value), samples[1024 + code] = static_cast<short>(-value);
      value += 1 << (code < 128 ? 0 : code / 128 - 1);
    }
    samples[1024] = 32767;
    decoder.loadLookupTable(samples.data());
    std::vector<unsigned char> offsets(phase_offsets.begin(), phase_offsets.end());
    decoder.loadP0TablesFromCommandResponse(offsets.data(), offsets.size());
  }

  bool onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) override {
    if (type != libfreenect2::Frame::Depth) return false;
    distance_m.reset(kSize, 0.0F);
    const auto* z_mm = reinterpret_cast<const float*>(frame->data);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = kSize.width - 1; x >= 0; --x, ++z_mm)
        if (const auto ray = lens.unproject({x, y}))
          distance_m.at(x, y) =
              1e-3F * *z_mm * static_cast<float>(std::sqrt(1 + ray->squaredNorm()));
    return false;  // the library may write into the frame again
  }

  /// Sends a picture as packets of the isochronous pipe; an empty packet ends it.
  void feed(std::vector<std::uint8_t>& picture) {
    for (std::size_t at = 0; at < picture.size(); at += kIsochronous_bytes)
      parser.onDataReceived(picture.data() + at, std::min(kIsochronous_bytes, picture.size() - at));
    parser.onDataReceived(picture.data(), 0);
  }
};

Libfreenect2Decoder::Libfreenect2Decoder(std::span<const std::uint8_t> phase_offsets,
                                         std::span<const std::uint8_t> infrared)
    : parts_(std::make_unique<Parts>(lens_of(infrared))) {
  parts_->decoder.setConfiguration({});
  parts_->load_tables(phase_offsets);
  parts_->decoder.setFrameListener(parts_.get());
  parts_->parser.setPacketProcessor(&parts_->decoder);
}

Libfreenect2Decoder::~Libfreenect2Decoder() = default;

const Image<float>& Libfreenect2Decoder::decode(std::span<const std::uint8_t> raw) {
  parts_->distance_m.reset({});
  std::vector<std::uint8_t> picture;
  for (std::size_t at = 0; at + device::kKinect2PacketBytes <= raw.size();
       at += device::kKinect2PacketBytes) {
    const auto bytes = raw.subspan(at, device::kKinect2PacketBytes);
    picture.assign(bytes.begin(), bytes.end());
    parts_->feed(picture);
  }
  // A picture of another frame ends this one.
  ++picture[device::kKinect2PictureBytes + kFooterFrame];
  parts_->feed(picture);
  return parts_->distance_m;
}

double Libfreenect2Decoder::cpu_s() const { return parts_->decoder.cpu_s; }

}  // namespace mixrig::test
