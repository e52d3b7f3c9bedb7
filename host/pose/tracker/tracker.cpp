// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/math/geometry/linear.h"
#include "host/math/geometry/motion.h"

namespace mixrig::tracking {
namespace {

constexpr int kPyramidLevels = 6;
/// Longest time over which constant velocity is assumed; a longer step does not predict the next.
constexpr double kLongestStep_s = 0.5;
constexpr double kFinerThanPicture = 0.75;  ///< size of the room's pixels relative to the picture's

PatchMapOptions map_options(const geometry::AnyCamera& camera, const AlignOptions& align) {
  PatchMapOptions options;
  options.finest_rad = kFinerThanPicture * (1 << align.finest) / geometry::parameters_of(camera)[0];
  return options;
}

}  // namespace

geometry::Pose looking_ahead() {
  Eigen::Matrix3d axes;
  axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return {Eigen::Quaterniond(axes), Eigen::Vector3d::Zero()};
}

geometry::Pose looking_at_the_scan(const model::Panorama& room) {
  constexpr double kHalfOfAll = 0.5;  // length of the mean of the directions of a hemisphere
  const Size size = room.size();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      if (room.distance_m.row(y)[x] <= 0) continue;
      const Eigen::Vector3d ray = model::direction_of(size, x, y);
      const double share = std::hypot(ray.x(), ray.y());  // rows shrink towards the poles
      sum += share * ray, area += share;
    }
  const geometry::Pose ahead = looking_ahead();
  if (!(sum.norm() > kHalfOfAll * area)) return ahead;
  const Eigen::Vector3d axis = ahead.rotation * Eigen::Vector3d::UnitZ();
  return {geometry::rotation_between(axis, sum) * ahead.rotation, ahead.translation_m};
}

Tracker::Tracker(const model::Panorama& room, const geometry::AnyCamera& camera,
                 const TrackerOptions& options, Crew& crew)
    : Tracker(
          make_patch_map(room, map_options(camera, options.align), crew), camera, options,
          [&](const PatchMap& map, const geometry::AnyCamera& own) {
            return std::make_unique<FirstPose>(room, map, own, options.align, crew);
          },
          crew) {
  start_.room_from_camera = looking_at_the_scan(room);
}

Tracker::Tracker(PatchMap map, const geometry::AnyCamera& camera, const TrackerOptions& options,
                 const MakeFinder& make_finder, Crew& crew)
    : camera_(camera),
      options_(options),
      start_{looking_ahead(), options.start_radius_m, options.start_radius_rad},
      crew_(crew),
      map_(std::move(map)),
      align_(map_, camera_, options.align),
      finder_(make_finder(map_, camera_)) {}

std::optional<geometry::Pose> Tracker::predicted(double time_s) const {
  if (!last_ || lost_) return std::nullopt;
  const double step_s = before_ ? last_->time_s - before_->time_s : 0;
  if (!(step_s > 0) || step_s > kLongestStep_s) return last_->room_from_camera;
  if (time_s - last_->time_s > kLongestStep_s) return last_->room_from_camera;
  return geometry::moved_on(before_->room_from_camera, last_->room_from_camera,
                            (time_s - last_->time_s) / step_s);
}

std::optional<PatchFit> Tracker::follow(double time_s) {
  const auto start = predicted(time_s);
  if (!start) return std::nullopt;
  // A good prediction needs no coarse level, on which few patches are in view.
  const geometry::Pose camera_from_room = geometry::inverse(*start);
  const int fine = std::min(align_.coarsest(), options_.align.finest + 1);
  PatchFit best = align_.align(picture_, camera_from_room, fine, options_.align.finest);
  // If most patches do not agree, an alignment from the coarsest level may be right where this one
  // is not: blur, repeating texture, people.
  constexpr double kMost = 0.5;
  for (const auto& from : {camera_from_room, geometry::inverse(last_->room_from_camera)}) {
    if (best.inliers > kMost * best.visible && explains(best)) break;
    const PatchFit fit = align_.align(picture_, from);
    if (share_of(fit) > share_of(best)) best = fit;
  }
  if (!explains(best)) return std::nullopt;
  return best;
}

std::optional<PatchFit> Tracker::search(double time_s) {
  ++counts_.searches;
  SearchField field = start_;
  if (last_) {
    const double passed_s = std::max(time_s - last_->time_s, 0.1);
    field.room_from_camera = last_->room_from_camera;
    field.radius_m = std::min(field.radius_m, 0.3 + options_.speed_m_s * passed_s);
    field.radius_rad = std::min(field.radius_rad, 0.3 + options_.speed_rad_s * passed_s);
  }
  auto fit = finder_->find(picture_, field);
  if (fit) ++counts_.found;
  return fit;
}

TrackedPose Tracker::known_pose(const PatchFit& fit) const {
  TrackedPose pose;
  pose.known = true;
  pose.room_from_camera = geometry::inverse(fit.camera_from_room);
  const Eigen::Matrix3d turn = pose.room_from_camera.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, 6> turns = Eigen::Matrix<double, 6, 6>::Zero();
  turns.topLeftCorner<3, 3>() = turns.bottomRightCorner<3, 3>() = turn;
  pose.covariance = turns * fit.covariance * turns.transpose();
  pose.covariance.diagonal().tail<3>().array() +=
      std::pow(options_.distance_sigma, 2) * pose.room_from_camera.translation_m.squaredNorm();
  pose.visible = fit.visible, pose.inliers = fit.inliers;
  return pose;
}

TrackedPose Tracker::track(ImageView<const Rgb8> picture, double time_s) {
  ++counts_.pictures;
  picture_.build(picture, kPyramidLevels, crew_);
  std::optional<PatchFit> fit = follow(time_s);
  const bool searched = !fit;
  if (!fit) fit = search(time_s);
  lost_ = !fit;
  if (!fit) {
    ++counts_.lost;
    before_.reset();
    return {};
  }
  TrackedPose pose = known_pose(*fit);
  pose.searched = searched;
  before_ = searched ? std::nullopt : last_;
  last_ = Past{time_s, pose.room_from_camera};
  return pose;
}

}  // namespace mixrig::tracking
