// SPDX-License-Identifier: Apache-2.0
#include "hal/device/depth_camera.h"

#include <algorithm>
#include <utility>

namespace mixrig::device {
namespace {

/// Passes frames through unchanged and adds the meaning of their numbers.
class DepthView final : public DepthCamera {
 public:
  DepthView(std::unique_ptr<Camera> camera, const DepthInfo& info)
      : camera_(std::move(camera)), depth_(info) {}
  const CameraInfo& info() const override { return camera_->info(); }
  const DepthInfo& depth() const override { return depth_; }
  Result<void> start(FrameSink sink) override { return camera_->start(std::move(sink)); }
  void stop() override { camera_->stop(); }
  StreamHealth health() const override { return camera_->health(); }
  DepthHealth depth_health() const override { return {}; }

 private:
  std::unique_ptr<Camera> camera_;
  DepthInfo depth_;
};

bool is_unknown(int step, const DepthInfo& info) {
  return std::find(info.unknown_steps.begin(), info.unknown_steps.end(), step) !=
         info.unknown_steps.end();
}

}  // namespace

Result<void> to_metres(const Frame& frame, const DepthInfo& info, Image<float>& out) {
  const bool steps = frame.format == PixelFormat::kDepth16 || frame.format == PixelFormat::kGray16;
  const std::size_t row = row_bytes(PixelFormat::kDepth16, frame.size.width);
  if (!steps || frame.size.empty() || frame.stride_bytes < row ||
      frame.bytes.size() <
          frame.stride_bytes * (static_cast<std::size_t>(frame.size.height) - 1) + row)
    return Error{ErrorCode::kData, "depth frame does not hold 16-bit depth of its size: dropped"};
  if (out.size() != frame.size) out.reset(frame.size);
  const std::span<const std::uint8_t> judged =
      frame.confidence.empty() ? frame.amplitude : frame.confidence;
  const bool judge = info.least_confidence > 0 && judged.size() >= 2 * frame.size.area();
  const std::uint8_t* confidence = judged.data();
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* source =
        frame.bytes.data() + static_cast<std::size_t>(y) * frame.stride_bytes;
    float* target = out.row(y);
    for (int x = 0; x < frame.size.width; ++x) {
      const int step = source[2 * x] | source[2 * x + 1] << 8;
      const double metres = step * info.metres_per_step + info.offset_m;
      target[x] = is_unknown(step, info) || !(metres > 0) ? 0.0F : static_cast<float>(metres);
    }
    if (!judge) continue;
    for (int x = 0; x < frame.size.width; ++x, confidence += 2)
      if ((confidence[0] | confidence[1] << 8) < info.least_confidence) target[x] = 0;
  }
  return {};
}

std::unique_ptr<DepthCamera> as_depth_camera(std::unique_ptr<Camera> camera,
                                             const DepthInfo& info) {
  return std::make_unique<DepthView>(std::move(camera), info);
}

}  // namespace mixrig::device
