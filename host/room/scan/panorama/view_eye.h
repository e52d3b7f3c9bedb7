// SPDX-License-Identifier: Apache-2.0
// A view of a sweep, asked what colour it sees at a point. Private to this module.
#pragma once

#include <optional>

#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Weight of a view's colour where its depth camera measured nothing.
inline constexpr float kUnmeasured = 1e-3F;

/// Keeps pointers to view and cameras. Any thread.
class ViewEye {
 public:
  ViewEye(const ScanView& view, const geometry::CameraModel& tof,
          const geometry::CameraModel& target);

  const Image<Rgb8>& plate() const { return view_->plate; }
  const ScanView& view() const { return *view_; }
  /// Where the target camera sees a point in base axes; nothing outside of its picture, or without
  /// a picture.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& point_m) const;
  /// Whether the depth camera sees the point (1), measured nothing or only what is behind it
  /// (kUnmeasured), or something before it (0).
  float visible(const Eigen::Vector3d& point_m) const;

 private:
  const ScanView* view_;
  const geometry::CameraModel *tof_, *target_;
  geometry::Pose tof_from_base_, target_from_base_;
  Eigen::Vector3d axis_;  ///< of the target camera, in base axes
  double least_cosine_;   ///< between it and a ray of the picture
};

}  // namespace mixrig::model
