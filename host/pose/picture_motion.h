// SPDX-License-Identifier: Apache-2.0
// Where the target camera is between and after the tracked pictures of a fisheye.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "host/calibration_file/calibration.h"
#include "host/geometry/pose.h"

namespace mixrig::pose {

/// How the plate's time is reached from the newest two pictures.
enum class Predict {
  kVelocity,  ///< the fisheye's motion goes on (constant velocity)
  kHead,      ///< the head turns by its angles, and what carries it stands still
  kBoth,      ///< the head turns by its angles, and the motion of what carries it goes on
};

/// Nothing allocates. Not thread-safe.
class PictureMotion {
 public:
  /// Without a chain of the head, kVelocity.
  PictureMotion(Predict by, const geometry::Pose& fisheye_from_target,
                std::optional<calibration_file::PanTilt> head);

  /// Angles of the head at a plate's time; times grow.
  void add_angles(double time_s, const device::PanTiltAngles& angles);
  /// The fisheye in the room at a picture's time; times grow. `apart`: found anew, nothing is known
  /// of the motion before it.
  void add_picture(double time_s, const geometry::Pose& room_from_fisheye, bool apart);
  /// The camera is lost: no pose until the next picture.
  void lose() { last_.reset(), before_.reset(); }

  /// room_from_target. Where the angles are not known at the time or at the pictures, by kVelocity.
  /// Past half a second after the newest picture the motion does not go on.
  std::optional<geometry::Pose> at(double time_s) const;

 private:
  struct Angles {
    double time_s = 0;
    device::PanTiltAngles angles;
  };
  struct Picture {
    double time_s = 0;
    geometry::Pose room_from_fisheye;
  };
  std::optional<device::PanTiltAngles> angles_at(double time_s) const;
  std::optional<geometry::Pose> by_head(double time_s) const;
  std::optional<geometry::Pose> room_from_base(const Picture& picture) const;

  const Predict by_;
  const geometry::Pose fisheye_from_target_;
  const std::optional<calibration_file::PanTilt> head_;
  std::array<Angles, 16> angles_{};  ///< the newest is at (count - 1) mod size
  std::size_t count_ = 0;
  std::optional<Picture> last_, before_;  ///< the newest two
};

}  // namespace mixrig::pose
