// SPDX-License-Identifier: Apache-2.0
// Finds where a view of a sweep sees a point, and whether something hides it. Private to this
// module.
#pragma once

#include <optional>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Weight of a view's colour where its depth camera measured nothing.
inline constexpr float kUnmeasured = 1e-3F;

/// Keeps pointers to the view and the cameras, which must outlive it. Thread-safe.
class ViewEye {
 public:
  ViewEye(const ScanView& view, const geometry::CameraModel& tof,
          const geometry::CameraModel& target);

  const Image<Rgb8>& plate() const { return view_->plate; }
  const ScanView& view() const { return *view_; }
  /// Pixel at which the target camera sees a point in base axes; nullopt outside of its picture, or
  /// without a picture.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& point_m) const;
  /// Visibility of a point to the depth camera: 1 if it sees the point, kUnmeasured if it measured
  /// nothing or only what is behind, 0 if it sees something before it.
  float visible(const Eigen::Vector3d& point_m) const;

 private:
  const ScanView* view_;
  const geometry::CameraModel *tof_, *target_;
  geometry::Pose tof_from_base_, target_from_base_;
  Eigen::Vector3d axis_;  ///< optical axis of the target camera, in base axes
  double least_cosine_;   ///< least cosine between the axis and a ray of the picture
};

}  // namespace mixrig::model
