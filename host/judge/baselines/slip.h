// SPDX-License-Identifier: Apache-2.0
// Slip of the virtual objects on the ground: measured against the true pose, and predicted from the
// covariance of the pose in use. docs/reference/report.md lists the keys.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "host/capture/capture/pose_source.h"
#include "host/judge/measure/slip.h"
#include "host/math/geometry/camera_model.h"

namespace mixrig::session {

/// Root mean squares over the contact points of one frame, px; nullopt without truth, covariance,
/// or a point in the picture.
struct FrameSlip {
  std::optional<double> measured_px, sigma_px;
};

/// Slip over all contact points of the frames.
struct SlipReport {
  struct Measured {
    double rms_px = 0, p95_px = 0, max_px = 0;
  };
  std::optional<Measured> measured;
  std::optional<double> sigma_px;  ///< predicted root mean square
  /// Share of the points, with truth and covariance, that lie within the ellipse of 95 %.
  std::optional<double> within_95_pct;
};

/// Measures slip frame by frame. Nothing allocates after construction. One thread.
class SlipWatch {
 public:
  /// `contacts_m`: contact points in world axes; `view`: the view that is composited.
  SlipWatch(std::vector<Eigen::Vector3d> contacts_m, const geometry::Pinhole& view)
      : contacts_m_(std::move(contacts_m)), view_(view) {}
  /// A frame that shows its objects by `used` (CameraPose::world_from_target also where it is
  /// lost). Points count that either pose shows within the picture; `known` is the true pose.
  FrameSlip add(const capture::CameraPose& used, const std::optional<geometry::Pose>& known) {
    return add(used, known, view_, view_);
  }
  /// Adds a frame of a zooming lens: `used_view` is the view in use and `known_view` the true one,
  /// both of the size of the view; the poses are those of the centres of projection.
  FrameSlip add(const capture::CameraPose& used, const std::optional<geometry::Pose>& known,
                const geometry::Pinhole& used_view, const geometry::Pinhole& known_view);
  SlipReport report() const;

 private:
  struct Seen {
    std::optional<measure::PixelPoint> px;
    bool inside = false;
  };
  static Seen seen(const Eigen::Vector3d& point_m, const geometry::Pose& world_from_target,
                   const geometry::Pinhole& view);

  const std::vector<Eigen::Vector3d> contacts_m_;
  const geometry::Pinhole view_;
  measure::SlipSums measured_;
  measure::SlipSums predicted_;
  std::uint64_t judged_ = 0, within_ = 0;
};

}  // namespace mixrig::session
