// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/tracker_poses.h"

#include <array>
#include <cmath>
#include <string>

#include "hal/base/clock.h"

namespace mixrig::pose {
namespace {

using capture::CameraPose;
using capture::PoseLoss;

constexpr std::array<const char*, 3> kWays{"constant velocity", "the angles of the head",
                                           "the angles of the head and constant velocity"};
/// Sigma of a hand-held camera's accelerations.
constexpr double kSpeedUp_m_s2 = 1, kSpeedUp_rad_s2 = 2;

class TrackerPoses final : public capture::PoseSource {
 public:
  TrackerPoses(const model::Panorama& room, const TrackerPoseOptions& options)
      : PoseSource({"tracker",
                    std::string("tracked: the fisheye's pictures against the scanned room; plates "
                                "are reached by ") +
                        kWays[static_cast<std::size_t>(options.predict)],
                    true, options.smooth_s}),
        options_(options),
        crew_(options.threads),
        motion_(options.predict, options.fisheye_from_target, options.head),
        tracker_(room, options.fisheye, options.tracker, crew_) {}

  void see(const capture::Capture& capture) override {
    const double plate_s = seconds(capture.mid_exposure.time_since_epoch());
    if (capture.pan_tilt && (!angles_s_ || plate_s > *angles_s_)) {
      angles_s_ = plate_s;
      motion_.add_angles(plate_s, *capture.pan_tilt);
    }
    take_picture(capture);
  }

  CameraPose pose_of(const capture::Capture& capture) override {
    see(capture);
    const double plate_s = seconds(capture.mid_exposure.time_since_epoch());
    if (capture.status_of(capture::Stream::kFisheye) == capture::StreamStatus::kMissing)
      return CameraPose::lost(PoseLoss::kNoPicture);
    const auto why = tracker_.counts().pictures == 0 ? PoseLoss::kAbsent : PoseLoss::kUntracked;
    if (options_.smooth_s > 0) {
      const auto place = motion_.smoothed_at(plate_s, options_.smooth_s);
      if (!place) return CameraPose::lost(why);
      CameraPose pose;
      pose.age_s = place->nearest_s;
      pose.world_from_target = options_.world_from_base * place->room_from_target;
      pose.covariance = in_world(place->covariance);
      return pose;
    }
    const auto room_from_target = motion_.at(plate_s);
    if (!room_from_target) return CameraPose::lost(why);
    CameraPose pose;
    pose.age_s = std::abs(plate_s - picture_s_);
    pose.world_from_target = options_.world_from_base * *room_from_target;
    pose.covariance = covariance_at(*room_from_target, plate_s - picture_s_);
    return pose;
  }

 private:
  void take_picture(const capture::Capture& capture) {
    if (capture.fisheye.size() != geometry::size_px(options_.fisheye)) return;
    const double time_s = seconds(capture.fisheye_mid_exposure.time_since_epoch());
    if (tracker_.counts().pictures > 0 && time_s <= picture_s_) return;
    picture_s_ = time_s;
    const tracking::TrackedPose tracked = tracker_.track(capture.fisheye, time_s);
    if (!tracked.known) return motion_.lose(time_s);
    covariance_ = tracked.covariance;
    motion_.add_picture({time_s, tracked.room_from_camera, tracked.covariance}, tracked.searched);
  }

  /// Returns the covariance of the target camera's pose in the world, `ahead_s` after the last
  /// picture.
  capture::PoseCovariance covariance_at(const geometry::Pose& room_from_target,
                                        double ahead_s) const {
    const Eigen::Vector3d arm_m =
        room_from_target.rotation * geometry::inverse(options_.fisheye_from_target).translation_m;
    capture::PoseCovariance c = moved_by(covariance_, -arm_m);
    if (ahead_s > 0) {
      const double way = 0.5 * ahead_s * ahead_s;
      c.diagonal().head<3>().array() += std::pow(kSpeedUp_rad_s2 * way, 2);
      c.diagonal().tail<3>().array() += std::pow(kSpeedUp_m_s2 * way, 2);
    }
    return in_world(c);
  }
  capture::PoseCovariance in_world(const capture::PoseCovariance& c) const {
    capture::PoseCovariance turn = capture::PoseCovariance::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
        options_.world_from_base.rotation.toRotationMatrix();
    return turn * c * turn.transpose();
  }

  const TrackerPoseOptions options_;
  Crew crew_;
  PictureMotion motion_;
  tracking::Tracker tracker_;
  std::optional<double> angles_s_;  ///< time of the newest plate with angles
  double picture_s_ = 0;            ///< time of the last picture given to the tracker
  capture::PoseCovariance covariance_ = capture::PoseCovariance::Zero();
};

}  // namespace

std::unique_ptr<capture::PoseSource> make_tracker_poses(const model::Panorama& room,
                                                        const TrackerPoseOptions& options) {
  return std::make_unique<TrackerPoses>(room, options);
}

}  // namespace mixrig::pose
