// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/picture_motion.h"

#include <algorithm>
#include <utility>

#include "host/math/geometry/motion.h"
#include "host/pose/source/pan_tilt_poses.h"

namespace mixrig::pose {
namespace {

using geometry::Pose;

constexpr double kLongestGap_s = 0.2;    ///< longest time between angles that are interpolated
constexpr double kLongestStep_s = 0.5;   ///< a longer step does not predict the next
constexpr double kAnglesAhead_s = 0.05;  ///< how far angles are extrapolated after the newest plate

double blend(double a, double b, double share) { return a + share * (b - a); }

}  // namespace

capture::PoseCovariance moved_by(const capture::PoseCovariance& covariance,
                                 const Eigen::Vector3d& arm_m) {
  capture::PoseCovariance by = capture::PoseCovariance::Identity();
  by.bottomLeftCorner<3, 3>() << 0, arm_m.z(), -arm_m.y(), -arm_m.z(), 0, arm_m.x(), arm_m.y(),
      -arm_m.x(), 0;
  return by * covariance * by.transpose();
}

PictureMotion::PictureMotion(Predict by, const Pose& fisheye_from_target,
                             std::optional<calibration_file::PanTilt> head)
    : by_(head ? by : Predict::kVelocity),
      fisheye_from_target_(fisheye_from_target),
      head_(std::move(head)) {}

void PictureMotion::add_angles(double time_s, const device::PanTiltAngles& angles) {
  angles_[count_++ % angles_.size()] = {time_s, angles};
}

void PictureMotion::add_picture(const MeasuredPose& picture, bool apart) {
  before_ = apart ? std::nullopt : last_;
  last_ = Picture{picture.time_s, picture.room_from_body};
  keep({picture, true, apart});
}

void PictureMotion::lose(double time_s) {
  last_.reset(), before_.reset();
  keep({{time_s, {}, capture::PoseCovariance::Zero()}, false, false});
}

/// Interpolates the angles linearly between two plates, and extrapolates for kAnglesAhead_s after
/// the newest.
std::optional<device::PanTiltAngles> PictureMotion::angles_at(double time_s) const {
  const std::size_t kept = std::min(count_, angles_.size());
  for (std::size_t back = 1; back < kept; ++back) {
    const Angles& after = angles_[(count_ - back) % angles_.size()];
    const Angles& before = angles_[(count_ - back - 1) % angles_.size()];
    if (time_s < before.time_s) continue;
    const double step_s = after.time_s - before.time_s;
    if (!(step_s > 0) || step_s > kLongestGap_s || time_s > after.time_s + kAnglesAhead_s)
      return std::nullopt;
    const double share = (time_s - before.time_s) / step_s;
    return device::PanTiltAngles{blend(before.angles.pan_rad, after.angles.pan_rad, share),
                                 blend(before.angles.tilt_rad, after.angles.tilt_rad, share)};
  }
  return std::nullopt;
}

/// Returns the pose of the head's base, which moves with what carries the head.
std::optional<Pose> PictureMotion::room_from_base(const Picture& picture) const {
  const auto angles = angles_at(picture.time_s);
  if (!angles) return std::nullopt;
  return picture.room_from_fisheye * fisheye_from_target_ *
         geometry::inverse(base_from_target(*head_, *angles));
}

std::optional<Pose> PictureMotion::by_head(double time_s) const {
  const auto angles = angles_at(time_s);
  auto base = room_from_base(*last_);
  if (!angles || !base) return std::nullopt;
  const bool moves = by_ == Predict::kBoth || time_s < last_->time_s;
  if (const auto before = before_ && moves ? room_from_base(*before_) : std::nullopt)
    base = geometry::moved_on(*before, *base,
                              (time_s - last_->time_s) / (last_->time_s - before_->time_s));
  return *base * base_from_target(*head_, *angles);
}

std::optional<Pose> PictureMotion::at(double time_s) const {
  if (!last_) return std::nullopt;
  const double step_s = before_ ? last_->time_s - before_->time_s : 0;
  const bool known = step_s > 0 && step_s <= kLongestStep_s;
  const bool near = time_s - last_->time_s <= kLongestStep_s;
  if (by_ != Predict::kVelocity && near)
    if (auto pose = by_head(time_s)) return pose;
  Pose fisheye = last_->room_from_fisheye;
  if (known && near)
    fisheye =
        geometry::moved_on(before_->room_from_fisheye, fisheye, (time_s - last_->time_s) / step_s);
  return fisheye * fisheye_from_target_;
}

/// Returns how many pictures ago the nearest one was; empty if it is lost.
std::optional<std::size_t> PictureMotion::nearest(double time_s) const {
  const std::size_t count = std::min(pictures_, kept_.size());
  std::optional<std::size_t> best;
  const auto off_s = [&](std::size_t back) { return std::abs(kept(back).fisheye.time_s - time_s); };
  for (std::size_t back = 0; back < count; ++back)
    if (!best || off_s(back) < off_s(*best)) best = back;
  if (!best || !kept(*best).known || off_s(*best) > kLongestStep_s) return std::nullopt;
  return best;
}

/// Writes the pictures around the nearest one, the oldest first; returns their number.
std::size_t PictureMotion::around(std::size_t nearest, double time_s, double reach_s,
                                  Around out) const {
  const std::size_t count = std::min(pictures_, kept_.size());
  const auto near = [&](std::size_t back) {
    return kept(back).known && std::abs(kept(back).fisheye.time_s - time_s) <= reach_s;
  };
  std::size_t oldest = nearest, newest = nearest;
  while (oldest + 1 < count && !kept(oldest).apart && near(oldest + 1)) ++oldest;
  while (newest > 0 && near(newest - 1) && !kept(newest - 1).apart) --newest;
  for (std::size_t back = oldest + 1; back-- > newest;) out[oldest - back] = kept(back).fisheye;
  return oldest - newest + 1;
}

/// Converts poses of the fisheye to poses of the head's base; false unless all angles are known.
bool PictureMotion::to_base(Around poses) const {
  for (MeasuredPose& p : poses) {
    const auto base = room_from_base({p.time_s, p.room_from_body});
    if (!base) return false;
    p.covariance = moved_by(p.covariance, base->translation_m - p.room_from_body.translation_m);
    p.room_from_body = *base;
  }
  return true;
}

std::optional<SmoothedPlace> PictureMotion::smoothed_at(double time_s, double reach_s) const {
  const auto at = nearest(time_s);
  if (!at) return std::nullopt;
  std::array<MeasuredPose, kMostSmoothed> poses;
  const Around used(poses.data(), around(*at, time_s, reach_s, poses));
  Pose body_from_target = fisheye_from_target_;
  if (const auto angles = angles_at(time_s); by_ != Predict::kVelocity && angles) {
    if (to_base(used))
      body_from_target = base_from_target(*head_, *angles);
    else
      around(*at, time_s, reach_s, poses);
  }
  const MeasuredPose body = smooth_at(used, time_s);
  SmoothedPlace place;
  place.room_from_target = body.room_from_body * body_from_target;
  place.covariance = moved_by(
      body.covariance, place.room_from_target.translation_m - body.room_from_body.translation_m);
  place.nearest_s = std::abs(kept(*at).fisheye.time_s - time_s);
  return place;
}

}  // namespace mixrig::pose
