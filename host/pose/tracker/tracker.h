// SPDX-License-Identifier: Apache-2.0
// The pose of a camera in a scanned room, picture after picture (Schiller et al. 2010,
// section 5.1).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "host/pose/tracker/first_pose.h"

namespace mixrig::tracking {

/// room_from_camera at the room's origin: ahead is y of the room, down is -z.
geometry::Pose looking_ahead();

/// The same, turned to the middle of what the scan saw, where that is less than half of all around.
geometry::Pose looking_at_the_scan(const model::Panorama& room);

struct TrackerOptions {
  AlignOptions align;
  /// Where the first pose is looked for: around the place of the scan and `looking_at_the_scan`.
  double start_radius_m = 1.2, start_radius_rad = 1.2;
  /// A camera that is lost is looked for around its last pose, in a field that grows so fast.
  double speed_m_s = 1, speed_rad_s = 2;
  /// Of what all distances of the room have in common, as a share of them. A room that is too large
  /// or too small by a share moves the camera by that share of its way from the place of the scan,
  /// and no patch lies off: the covariance has as much in every direction.
  double distance_sigma = 0;
};

/// What is known of one picture's camera.
struct TrackedPose {
  bool known = false;
  geometry::Pose room_from_camera;
  /// Of (rotation vector rad, translation m) in axes of the room: R = exp(w) * R_estimate.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  int visible = 0, inliers = 0;  ///< patches
  bool searched = false;         ///< without the pose before
};

struct TrackerCounts {
  std::uint64_t pictures = 0, lost = 0, searches = 0;
  std::uint64_t found = 0;  ///< by a search
};

/// Aligns the room's patches to each picture from the pose that constant velocity predicts. Each
/// picture is held against the room itself, so errors do not add up. A picture that the room does
/// not explain is lost, and the camera is looked for. Does not allocate while it is tracked. Not
/// thread-safe.
class Tracker {
 public:
  /// `room` is read here alone; `crew` must outlive the tracker.
  Tracker(const model::Panorama& room, const geometry::AnyCamera& camera,
          const TrackerOptions& options, Crew& crew);
  /// Makes what finds the camera; map and camera outlive it.
  using MakeFinder =
      std::function<std::unique_ptr<PoseFinder>(const PatchMap&, const geometry::AnyCamera&)>;
  /// Of any map of patches, in metres.
  Tracker(PatchMap map, const geometry::AnyCamera& camera, const TrackerOptions& options,
          const MakeFinder& make_finder, Crew& crew);
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// A picture of the camera's size; times grow.
  TrackedPose track(ImageView<const Rgb8> picture, double time_s);
  /// The next picture is looked for as the first one is.
  void forget() { last_.reset(), before_.reset(), lost_ = true; }
  /// What constant velocity says of a time near the last picture's; none before the first pose and
  /// while the camera is lost.
  std::optional<geometry::Pose> predicted(double time_s) const;

  const TrackerCounts& counts() const { return counts_; }
  /// The patches of the last picture that was not searched for.
  const PatchAlign& patches() const { return align_; }

 private:
  struct Past {
    double time_s = 0;
    geometry::Pose room_from_camera;
  };
  std::optional<PatchFit> follow(double time_s);
  std::optional<PatchFit> search(double time_s);
  TrackedPose known_pose(const PatchFit& fit) const;

  const geometry::AnyCamera camera_;
  const TrackerOptions options_;
  SearchField start_;  ///< of the first pose
  Crew& crew_;
  const PatchMap map_;
  PatchAlign align_;
  const std::unique_ptr<const PoseFinder> finder_;
  GreyPyramid picture_;
  std::optional<Past> last_, before_;  ///< the newest two poses that were known
  bool lost_ = true;
  TrackerCounts counts_;
};

}  // namespace mixrig::tracking
