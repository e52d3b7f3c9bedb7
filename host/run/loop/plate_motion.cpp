// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/plate_motion.h"

namespace mixrig::session {
namespace {

glm::vec3 to_vec(const Eigen::Vector3d& v) { return glm::vec3(v.x(), v.y(), v.z()); }

}  // namespace

/// Motion of points from the last frame, in axes of the current camera.
std::optional<PlateMotion::Rate> PlateMotion::step_to(const geometry::Pose& world_from_target,
                                                      double time_s) const {
  const double step_s = time_s - last_s_;
  if (!last_ || !(step_s > 0 && step_s <= kMostGap_s)) return std::nullopt;
  const geometry::Pose now_from_last = geometry::inverse(world_from_target) * *last_;
  const Eigen::AngleAxisd turn(now_from_last.rotation);
  return Rate{turn.axis() * turn.angle() / step_s, now_from_last.translation_m / step_s, step_s};
}

std::optional<render::CameraMotion> PlateMotion::next(const capture::CameraPose& pose,
                                                      double time_s) {
  if (!(exposure_s_ > 0)) return std::nullopt;
  if (!pose.ok()) {
    last_.reset(), last_rate_.reset();
    return std::nullopt;
  }
  const std::optional<Rate> before = last_rate_;
  last_rate_ = step_to(pose.world_from_target, time_s);
  last_ = pose.world_from_target, last_s_ = time_s;
  if (!last_rate_) return std::nullopt;
  Rate now = *last_rate_;
  if (before) {
    const double ahead = now.step_s / (now.step_s + before->step_s);
    now.turn_rad += ahead * (now.turn_rad - before->turn_rad);
    now.shift_m += ahead * (now.shift_m - before->shift_m);
  }
  return render::CameraMotion{to_vec(exposure_s_ * now.turn_rad),
                              to_vec(exposure_s_ * now.shift_m)};
}

}  // namespace mixrig::session
