// SPDX-License-Identifier: Apache-2.0
#include "extras/kinect2/kinect2_depth.h"

#include <algorithm>
#include <cstddef>

#include "host/capture/depth/phase_decoder.h"

namespace mixrig::device {
namespace {

constexpr double kKinectStep_m = 0.00025;

void put(std::span<std::uint8_t> to, std::size_t pixel, float value) {
  const auto v = static_cast<std::uint16_t>(std::clamp(value + 0.5F, 0.0F, 65535.0F));
  to[2 * pixel] = static_cast<std::uint8_t>(v);
  to[2 * pixel + 1] = static_cast<std::uint8_t>(v >> 8);
}

class Kinect2Decoder final : public RawDepthDecoder {
 public:
  explicit Kinect2Decoder(const depth::PhaseCamera& camera) : decoder_(camera) {
    info_.metres_per_step = kKinectStep_m;
    info_.meaning = DepthMeaning::kDistance;
    info_.amplitude_is_light = true;
    info_.least_confidence = static_cast<int>(65535 * depth::kLeastConfidence);
    const geometry::Pinhole& p = camera.lens.pinhole;
    info_.intrinsics = DeviceIntrinsics{0.5 * (p.fx_px + p.fy_px), p.cx_px, p.cy_px};
  }
  const DepthInfo& depth() const override { return info_; }
  void decode(std::span<const std::uint8_t> pictures, std::span<std::uint8_t> steps,
              std::span<std::uint8_t> amplitude, std::span<std::uint8_t> confidence) override {
    decoder_.decode(pictures, out_);
    std::size_t pixel = 0;
    for (int y = 0; y < out_.distance_m.height(); ++y)
      for (int x = 0; x < out_.distance_m.width(); ++x, ++pixel) {
        put(steps, pixel, out_.distance_m.row(y)[x] * static_cast<float>(1 / kKinectStep_m));
        put(amplitude, pixel, out_.amplitude.row(y)[x]);
        put(confidence, pixel, 65535 * out_.confidence.row(y)[x]);
      }
  }

 private:
  DepthInfo info_;
  depth::PhaseDecoder decoder_;
  depth::PhaseDepth out_;
};

}  // namespace

std::unique_ptr<RawDepthDecoder> make_kinect2_decoder(const Kinect2Infrared& infrared,
                                                      const Kinect2Offsets& offsets) {
  return std::make_unique<Kinect2Decoder>(depth::kinect2_phase_camera(infrared, offsets));
}

}  // namespace mixrig::device
