// SPDX-License-Identifier: Apache-2.0
#include "host/pose/picture_motion.h"

#include <algorithm>
#include <utility>

#include "host/geometry/motion.h"
#include "host/pose/pan_tilt_poses.h"

namespace mixrig::pose {
namespace {

using geometry::Pose;

constexpr double kLongestGap_s = 0.2;    ///< between angles that are interpolated
constexpr double kLongestStep_s = 0.5;   ///< a longer one says nothing about the next
constexpr double kAnglesAhead_s = 0.05;  ///< of a picture after the newest plate

double blend(double a, double b, double share) { return a + share * (b - a); }

}  // namespace

PictureMotion::PictureMotion(Predict by, const Pose& fisheye_from_target,
                             std::optional<calibration_file::PanTilt> head)
    : by_(head ? by : Predict::kVelocity),
      fisheye_from_target_(fisheye_from_target),
      head_(std::move(head)) {}

void PictureMotion::add_angles(double time_s, const device::PanTiltAngles& angles) {
  angles_[count_++ % angles_.size()] = {time_s, angles};
}

void PictureMotion::add_picture(double time_s, const Pose& room_from_fisheye, bool apart) {
  before_ = apart ? std::nullopt : last_;
  last_ = Picture{time_s, room_from_fisheye};
}

/// Linear between two plates, and a little after the newest.
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

/// Of the head's base, which what carries the head moves.
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

}  // namespace mixrig::pose
