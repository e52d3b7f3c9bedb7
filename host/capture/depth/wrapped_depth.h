// SPDX-License-Identifier: Apache-2.0
// Finds depth that phase wrap made too near.
#pragma once

#include <vector>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::depth {

/// A ToF camera measures distances modulo its unambiguous range. Surfaces beyond it, and those seen
/// in a mirror, appear too near, but with the weak light of their true distance: amplitude times
/// squared distance, the reflectivity that a surface at the measured distance would have, is a few
/// hundredths of the room's (the amplitude test of McClure et al. 2010, "Resolving
/// depth-measurement ambiguity with commercially available range imaging cameras"). It is compared
/// with the median of the picture. Black surfaces mostly lie above that share; otherwise their
/// depth is lost. Depth that wraps to slightly less than its true distance is not found.
/// Not thread-safe.
class WrappedDepth {
 public:
  /// Depth whose reflectivity is below this share of the median counts as wrapped. What a kinect2
  /// sees in the studio's mirror is below it; black clothes in a dark room hardly ever are
  /// (docs/reference/studio.md).
  static constexpr float kLeastShare = 0.03F;

  /// `depth_is_distance`: depth is along the ray, not along z.
  WrappedDepth(const geometry::CameraModel& tof, bool depth_is_distance);

  /// Sets wrapped depths to unknown (0) in place and returns their number. Changes nothing if too
  /// few pixels are known for a median. Allocates nothing.
  /// Precondition: pictures of the camera's size.
  int remove(ImageView<float> depth_m, ImageView<const float> amplitude);

 private:
  float reflectivity(ImageView<const float> depth_m, ImageView<const float> amplitude, int x,
                     int y) const {
    const float z = depth_m.row(y)[x];
    return amplitude.row(y)[x] * z * z * ray2_.row(y)[x];
  }

  Image<float> ray2_;  ///< squared distance per squared depth
  std::vector<float> sample_;
};

}  // namespace mixrig::depth
