// SPDX-License-Identifier: Apache-2.0
// Depth whose light came from farther away than the camera says.
#pragma once

#include <vector>

#include "hal/base/image.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::depth {

/// A ToF camera measures distances modulo its unambiguous range. What is beyond it, and what a
/// mirror shows, comes out too near, but the light is weak as from the true distance: amplitude
/// times squared distance, the reflectivity that a surface would have there, is a few hundredths of
/// that of the room (the amplitude test of McClure et al. 2010, "Resolving depth-measurement
/// ambiguity with commercially available range imaging cameras"). The median of the picture is the
/// measure. Black things are above that share; where they are not, their depth is lost. What wraps
/// to little less than its true distance stays.
/// Not thread-safe.
class WrappedDepth {
 public:
  /// Of the median reflectivity: what the mirror of the studio shows to a kinect2 is below, black
  /// clothes in a dark room are hardly (docs/reference/studio.md).
  static constexpr float kLeastShare = 0.03F;

  /// `depth_is_distance`: depth is along the ray, not along z.
  WrappedDepth(const geometry::CameraModel& tof, bool depth_is_distance);

  /// Makes such depths unknown (0) in place and says how many there were. Allocates nothing.
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
