// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/wrapped_depth.h"

#include <span>

#include "hal/base/order_statistics.h"

namespace mixrig::depth {
namespace {

constexpr int kSampled_px = 5;            ///< step between sampled pixels in x and y
constexpr std::size_t kLeastSample = 50;  ///< a smaller sample has no useful median

}  // namespace

WrappedDepth::WrappedDepth(const geometry::CameraModel& tof, bool depth_is_distance)
    : ray2_(tof.size_px(), 1.0F) {
  const Size size = tof.size_px();
  sample_.reserve(static_cast<std::size_t>(size.width / kSampled_px + 1) *
                  static_cast<std::size_t>(size.height / kSampled_px + 1));
  if (depth_is_distance) return;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (const auto ray = tof.unproject({x, y}))
        ray2_.row(y)[x] = static_cast<float>(1 + ray->squaredNorm());
}

int WrappedDepth::remove(ImageView<float> depth_m, ImageView<const float> amplitude) {
  const ImageView<const float> seen = depth_m;
  sample_.clear();
  for (int y = 0; y < seen.size.height; y += kSampled_px)
    for (int x = 0; x < seen.size.width; x += kSampled_px)
      if (const float r = reflectivity(seen, amplitude, x, y); r > 0) sample_.push_back(r);
  if (sample_.size() < kLeastSample) return 0;
  const float least = kLeastShare * upper_median_in_place(std::span(sample_));
  int removed = 0;
  for (int y = 0; y < seen.size.height; ++y) {
    float* row = depth_m.row(y);
    for (int x = 0; x < seen.size.width; ++x) {
      const bool gone = row[x] > 0 && reflectivity(seen, amplitude, x, y) < least;
      row[x] = gone ? 0.0F : row[x];
      removed += gone ? 1 : 0;
    }
  }
  return removed;
}

}  // namespace mixrig::depth
