// SPDX-License-Identifier: Apache-2.0
// Removes the systematic error from the pictures of a ToF camera.
#pragma once

#include <vector>

#include "hal/base/image.h"
#include "host/capture/calibration_file/calibration.h"

namespace mixrig::depth {

/// Tables of a calibration_file::DepthError, made once: apply() allocates nothing. Immutable, so
/// thread-safe.
class DepthCorrection {
 public:
  /// `depth_is_distance`: depth is along the ray, not along z.
  DepthCorrection(const calibration_file::DepthError& error, const geometry::CameraModel& tof,
                  bool depth_is_distance);

  bool wants_amplitude() const { return amplitude_m_ != 0.0F; }
  /// Corrects metres in place; unknown values (0, negative, not finite) stay, and so do pixels
  /// where the lens has no ray. If `amplitude` is empty its term is left out.
  /// Precondition: pictures of the camera's size.
  void apply(ImageView<float> depth_m, ImageView<const float> amplitude) const;

 private:
  float at(float distance_m) const;

  float first_m_ = 0, steps_per_m_ = 1;
  std::vector<float> error_m_;  ///< at the distances first_m_ + index / steps_per_m_
  float amplitude_m_ = 0;
  Image<float> place_m_;  ///< error by the place in the picture
  Image<float> ray_;      ///< distance per depth
};

}  // namespace mixrig::depth
