// SPDX-License-Identifier: Apache-2.0
// Finds the pose of a camera without a start value.
#pragma once

#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "host/pose/tracker/patch_align.h"

namespace mixrig::tracking {

/// Region of poses in which the camera is searched for.
struct SearchField {
  geometry::Pose room_from_camera;  ///< middle of the region
  double radius_m = 1.2;
  double radius_rad = 1.2;
};

/// Searches for the pose of a camera.
class PoseFinder {
 public:
  virtual ~PoseFinder() = default;
  /// Returns a pose that explains the picture (`explains`); empty if there is none, never a guess.
  /// `field`: where to search, if the finder needs it.
  virtual std::optional<PatchFit> find(const GreyPyramid& picture,
                                       const SearchField& field) const = 0;
};

/// Compares a coarse picture with the coarse room at all poses of a grid, by the correlation of
/// grey values along the picture's rays; the best poses are aligned, and the best of these down to
/// the finest level. Not thread-safe; allocates.
class FirstPose final : public PoseFinder {
 public:
  /// `map` and `camera` must outlive it.
  FirstPose(const model::Panorama& room, const PatchMap& map, const geometry::AnyCamera& camera,
            const AlignOptions& options, Crew& crew);

  /// Returns the best pose; empty if no pose of the field explains the picture (`explains`), or if
  /// another one explains it nearly as well.
  std::optional<PatchFit> find(const GreyPyramid& picture, const SearchField& field) const override;

  /// A point on the coarse room.
  struct Surface {
    Eigen::Vector3f place_m;
    float grey;
  };

 private:
  void guess(const GreyPyramid& picture, const SearchField& field,
             std::vector<PatchFit>& best_first) const;
  void align_all(const GreyPyramid& picture, int coarsest, int finest, int patches,
                 std::vector<PatchFit>& best_first) const;

  const PatchMap& map_;
  const geometry::AnyCamera& camera_;
  const AlignOptions options_;
  Crew& crew_;
  std::vector<Surface> surfaces_;
};

/// Returns the share, 0 to 1, of the patches expected in the picture that match it in grey values
/// and position.
double share_of(const PatchFit& fit);
/// Whether enough patches match in grey values and position to trust the pose.
bool explains(const PatchFit& fit);

}  // namespace mixrig::tracking
