// SPDX-License-Identifier: Apache-2.0
// Tracks the pose of a camera in a scanned room from picture to picture (Schiller et al. 2010,
// section 5.1).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "host/pose/tracker/first_pose.h"

namespace mixrig::tracking {

/// Returns room_from_camera at the room's origin: viewing direction y of the room, down -z.
geometry::Pose looking_ahead();

/// Returns looking_ahead(), turned to the middle of the scanned part if that is less than half of
/// all directions.
geometry::Pose looking_at_the_scan(const model::Panorama& room);

struct TrackerOptions {
  AlignOptions align;
  /// Region of the search for the first pose: around the place of the scan and
  /// `looking_at_the_scan`.
  double start_radius_m = 1.2, start_radius_rad = 1.2;
  /// A lost camera is searched for around its last pose, in a region that grows at these speeds.
  double speed_m_s = 1, speed_rad_s = 2;
  /// Standard deviation of the room's scale, as a share. A room whose scale is wrong by a share
  /// moves the camera by that share of its way from the place of the scan without shifting any
  /// patch, so the covariance gets this much in every direction.
  double distance_sigma = 0;
};

/// Pose of the camera in one picture.
struct TrackedPose {
  bool known = false;
  geometry::Pose room_from_camera;
  /// Covariance of (rotation vector rad, translation m) in axes of the room: R = exp(w) *
  /// R_estimate.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  int visible = 0, inliers = 0;  ///< patches
  bool searched = false;         ///< found by a search, without the last pose
};

struct TrackerCounts {
  std::uint64_t pictures = 0, lost = 0, searches = 0;
  std::uint64_t found = 0;  ///< poses found by a search
};

/// Aligns the room's patches to each picture from the pose that constant velocity predicts. Each
/// picture is compared with the room itself, so errors do not accumulate. A picture that the room
/// does not explain is lost, and the camera is searched for. Does not allocate while the camera is
/// tracked. Not thread-safe.
class Tracker {
 public:
  /// `room` is read only by the constructor; `crew` must outlive the tracker.
  Tracker(const model::Panorama& room, const geometry::AnyCamera& camera,
          const TrackerOptions& options, Crew& crew);
  /// Makes the finder of a lost camera; map and camera outlive it.
  using MakeFinder =
      std::function<std::unique_ptr<PoseFinder>(const PatchMap&, const geometry::AnyCamera&)>;
  /// Makes a tracker for any map of patches, in metres.
  Tracker(PatchMap map, const geometry::AnyCamera& camera, const TrackerOptions& options,
          const MakeFinder& make_finder, Crew& crew);
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  /// Tracks the camera in the next picture, which has the camera's size; times grow.
  TrackedPose track(ImageView<const Rgb8> picture, double time_s);
  /// Forgets the last pose: in the next picture the camera is searched for, as in the first one.
  void forget() { last_.reset(), before_.reset(), lost_ = true; }
  /// Returns the pose by constant velocity at a time near the last picture's; empty before the
  /// first pose and while the camera is lost.
  std::optional<geometry::Pose> predicted(double time_s) const;

  const TrackerCounts& counts() const { return counts_; }
  /// The patches of the last picture tracked without a search.
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
  SearchField start_;  ///< search region of the first pose
  Crew& crew_;
  const PatchMap map_;
  PatchAlign align_;
  const std::unique_ptr<const PoseFinder> finder_;
  GreyPyramid picture_;
  std::optional<Past> last_, before_;  ///< the newest two known poses
  bool lost_ = true;
  TrackerCounts counts_;
};

}  // namespace mixrig::tracking
