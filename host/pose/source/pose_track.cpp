// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/pose_track.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/math/estimation/verdict.h"

namespace mixrig::pose {
namespace {

using capture::CameraPose;
using capture::PoseCovariance;
using capture::PoseLoss;
using geometry::Pose;

PoseCovariance both_turned(const Eigen::Quaterniond& by, const PoseCovariance& covariance) {
  PoseCovariance j = PoseCovariance::Zero();
  j.topLeftCorner<3, 3>() = j.bottomRightCorner<3, 3>() = by.toRotationMatrix();
  return j * covariance * j.transpose();
}

/// Returns the covariance of a product left * right from those of both.
PoseCovariance product(const Pose& left, const PoseCovariance& left_covariance, const Pose& right,
                       const std::optional<PoseCovariance>& right_covariance) {
  PoseCovariance j = PoseCovariance::Identity();
  j.bottomLeftCorner<3, 3>() =
      -estimation::skew(Eigen::Vector3d(left.rotation * right.translation_m));
  PoseCovariance sum = j * left_covariance * j.transpose();
  if (right_covariance) sum += both_turned(left.rotation, *right_covariance);
  return sum;
}

/// Returns the pose `part` of the way from a to b; beyond b for part > 1.
Pose along(const Pose& a, const Pose& b, double part) {
  const Eigen::Vector3d turn = estimation::rotation_log(b.rotation * a.rotation.conjugate());
  return {estimation::rotation_exp(part * turn) * a.rotation,
          a.translation_m + part * (b.translation_m - a.translation_m)};
}

DeviceTime stamp_of(double time_s) {
  return DeviceTime(Duration(static_cast<Duration::rep>(std::llround(time_s * 1e9))));
}

constexpr double kLongest_s = 1e9;  ///< largest time of a stream's clock that fits nanoseconds

}  // namespace

Mount mount_of(const calibration_file::CalibratedPose& body) {
  Mount mount{geometry::inverse(body.target_from), {}};
  if (body.covariance.rows() != 6) return mount;
  const Eigen::Matrix3d r = mount.body_from_target.rotation.toRotationMatrix();
  PoseCovariance j = PoseCovariance::Zero();
  j.topLeftCorner<3, 3>() = j.bottomRightCorner<3, 3>() = -r;
  j.bottomLeftCorner<3, 3>() = -r * estimation::skew(body.target_from.translation_m);
  mount.covariance = j * PoseCovariance(body.covariance) * j.transpose();
  return mount;
}

TargetSeen on_body(const Pose& world_from_body,
                   const std::optional<PoseCovariance>& body_covariance, const Mount& mount) {
  TargetSeen seen{world_from_body * mount.body_from_target, {}};
  if (body_covariance)
    seen.covariance =
        product(world_from_body, *body_covariance, mount.body_from_target, mount.covariance);
  return seen;
}

void PoseTrack::add(double time_s, const std::optional<TargetSeen>& seen, HostTime received) {
  const std::lock_guard lock(mutex_);
  if (!(std::abs(time_s) < kLongest_s)) {
    ++faults_.not_finite;
    return;
  }
  if (!options_.host_time &&
      clock_.add(stamp_of(time_s), received) == sync::DeviceClock::Verdict::kRestarted)
    restart();
  if (!seen) {
    ++faults_.refused;
    return;
  }
  const std::uint64_t steps = check_.faults().clock_steps;
  const Sample sample{{time_s, seen->world_from_target}, seen->covariance};
  switch (check_.add(sample.timed)) {
    case MotionCheck::Verdict::kTake:
      return keep(sample);
    case MotionCheck::Verdict::kRestart:
      count_ = 0;
      for (const trajectory::TimedPose& timed : check_.run()) keep({timed, seen->covariance});
      return;
    case MotionCheck::Verdict::kRejected:
      break;
  }
  if (check_.faults().clock_steps == steps) return;
  // The clock was set back by less than DeviceClock can distinguish from a delay.
  clock_ = {};
  (void)clock_.add(stamp_of(time_s), received);
  count_ = 0;
}

void PoseTrack::restart() {
  ++faults_.clock_steps;
  const capture::PoseFaults before = std::exchange(check_, {}).faults();
  faults_.jumps += before.jumps;
  faults_.not_finite += before.not_finite;
  faults_.clock_steps += before.clock_steps;
  count_ = 0;
}

void PoseTrack::keep(const Sample& sample) {
  kept_[end_] = sample;
  end_ = (end_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
}

capture::PoseFaults PoseTrack::faults() const {
  const std::lock_guard lock(mutex_);
  capture::PoseFaults all = faults_;
  all.jumps += check_.faults().jumps;
  all.not_finite += check_.faults().not_finite;
  all.clock_steps += check_.faults().clock_steps;
  return all;
}

capture::PoseStream PoseTrack::stream() const {
  const std::lock_guard lock(mutex_);
  return {0, options_.delay_s, seconds(clock_.jitter()), clock_.drift_ppm()};
}

/// Returns the stream's time at a host time. The drift since the newest frame is below a
/// microsecond.
std::optional<double> PoseTrack::stream_time_s(HostTime at) const {
  if (options_.host_time) return seconds(at.time_since_epoch()) + options_.delay_s;
  const double newest_s = newest(0).timed.t_s;
  const auto arrived = clock_.to_host(stamp_of(newest_s));
  if (!arrived) return std::nullopt;
  return newest_s + seconds(at - *arrived) + options_.delay_s;
}

CameraPose PoseTrack::at(HostTime mid_exposure) const {
  const std::lock_guard lock(mutex_);
  if (count_ == 0) return CameraPose::lost(PoseLoss::kNoSample);
  const auto t_s = stream_time_s(mid_exposure);
  if (!t_s) return CameraPose::lost(PoseLoss::kOutside);
  if (*t_s > newest(0).timed.t_s) return ahead(*t_s);
  std::size_t i = 1;  // newest(i) is the last one before t_s
  while (i < count_ && newest(i).timed.t_s > *t_s) ++i;
  if (i == count_)
    return newest(0).timed.t_s == *t_s ? ahead(*t_s) : CameraPose::lost(PoseLoss::kOutside);
  const Sample &a = newest(i), &b = newest(i - 1);
  const double step_s = b.timed.t_s - a.timed.t_s;
  if (step_s > options_.gap_s) return CameraPose::lost(PoseLoss::kGap);
  const double part = (*t_s - a.timed.t_s) / step_s;
  CameraPose pose;
  pose.world_from_target = along(a.timed.world_from_body, b.timed.world_from_body, part);
  pose.covariance = (part < 0.5 ? a : b).covariance;
  pose.age_s = std::min(part, 1 - part) * step_s;
  return pose;
}

CameraPose PoseTrack::ahead(double t_s) const {
  const Sample& last = newest(0);
  const double ahead_s = t_s - last.timed.t_s;
  if (ahead_s > options_.most_ahead_s) return CameraPose::lost(PoseLoss::kTooOld);
  std::size_t i = 0;
  while (i + 1 < count_ && last.timed.t_s - newest(i).timed.t_s < kMotion_s &&
         newest(i).timed.t_s - newest(i + 1).timed.t_s <= options_.gap_s)
    ++i;
  CameraPose pose;
  pose.age_s = ahead_s;
  pose.world_from_target = last.timed.world_from_body;
  pose.covariance = last.covariance;
  if (i == 0) return pose;
  const Sample& first = newest(i);
  const double share = ahead_s / (last.timed.t_s - first.timed.t_s);
  pose.world_from_target =
      along(first.timed.world_from_body, last.timed.world_from_body, 1 + share);
  // last + share * (last - first), both with the same noise.
  if (pose.covariance) *pose.covariance *= (1 + share) * (1 + share) + share * share;
  return pose;
}

}  // namespace mixrig::pose
