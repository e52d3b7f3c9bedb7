// SPDX-License-Identifier: Apache-2.0
// Pose of the target camera between and after the tracked pictures of a fisheye.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "host/capture/calibration_file/calibration.h"
#include "host/math/geometry/pose.h"
#include "host/pose/source/smooth_poses.h"

namespace mixrig::pose {

/// How the motion is extrapolated from the newest two pictures to the plate's time.
enum class Predict {
  kVelocity,  ///< the fisheye's motion continues (constant velocity)
  kHead,      ///< the head turns by its angles, and what carries it stands still
  kBoth,      ///< the head turns by its angles, and the motion of what carries it continues
};

/// Returns the covariance of a point fixed to a body of known covariance, `arm_m` away from it;
/// both in axes of the room.
capture::PoseCovariance moved_by(const capture::PoseCovariance& covariance,
                                 const Eigen::Vector3d& arm_m);

/// A pose of the target camera, smoothed over earlier and later pictures.
struct SmoothedPlace {
  geometry::Pose room_from_target;
  capture::PoseCovariance covariance;  ///< in axes of the room
  double nearest_s = 0;                ///< time to the nearest picture
};

/// Interpolates and extrapolates the pose between pictures. Nothing allocates. Not thread-safe.
class PictureMotion {
 public:
  /// `head`: calibration of the head; without it kVelocity is used.
  PictureMotion(Predict by, const geometry::Pose& fisheye_from_target,
                std::optional<calibration_file::PanTilt> head);

  /// Adds the angles of the head at a plate's time; times grow.
  void add_angles(double time_s, const device::PanTiltAngles& angles);
  /// Adds the pose of the fisheye in the room at a picture's time; times grow. `apart`: the camera
  /// was found again, and its earlier motion is unknown.
  void add_picture(const MeasuredPose& picture, bool apart);
  /// Notes that the camera is lost in a picture: there is no pose until the next picture.
  void lose(double time_s);

  /// Returns room_from_target. It uses kVelocity if the angles are not known at the time or at the
  /// pictures. Later than half a second after the newest picture the motion is not continued.
  std::optional<geometry::Pose> at(double time_s) const;
  /// Returns the pose smoothed over the pictures up to `reach_s` before and after the time, without
  /// a lost one between (smooth_at). With the head's angles, the motion of what carries the head is
  /// smoothed; if an angle is not known, that of the fisheye. Empty if the nearest picture is lost,
  /// or half a second away.
  std::optional<SmoothedPlace> smoothed_at(double time_s, double reach_s) const;

 private:
  struct Angles {
    double time_s = 0;
    device::PanTiltAngles angles;
  };
  struct Picture {
    double time_s = 0;
    geometry::Pose room_from_fisheye;
  };
  struct Kept {
    MeasuredPose fisheye;  ///< only the time is set if it is lost
    bool known = false, apart = false;
  };
  using Around = std::span<MeasuredPose>;
  std::optional<device::PanTiltAngles> angles_at(double time_s) const;
  std::optional<geometry::Pose> by_head(double time_s) const;
  std::optional<geometry::Pose> room_from_base(const Picture& picture) const;

  const Predict by_;
  const geometry::Pose fisheye_from_target_;
  const std::optional<calibration_file::PanTilt> head_;
  const Kept& kept(std::size_t back) const { return kept_[(pictures_ - 1 - back) % kept_.size()]; }
  void keep(const Kept& picture) { kept_[pictures_++ % kept_.size()] = picture; }
  std::optional<std::size_t> nearest(double time_s) const;
  std::size_t around(std::size_t nearest, double time_s, double reach_s, Around out) const;
  bool to_base(Around poses) const;

  static constexpr std::size_t kMostAngles = 64;
  std::array<Angles, kMostAngles> angles_{};  ///< the newest is at (count - 1) mod size
  std::size_t count_ = 0;
  std::optional<Picture> last_, before_;    ///< the newest two
  std::array<Kept, kMostSmoothed> kept_{};  ///< the newest is at (pictures - 1) mod size
  std::size_t pictures_ = 0;
};

}  // namespace mixrig::pose
