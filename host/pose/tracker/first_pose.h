// SPDX-License-Identifier: Apache-2.0
// Where a camera is, without a start value.
#pragma once

#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "host/pose/tracker/patch_align.h"

namespace mixrig::tracking {

/// The camera is looked for around a place.
struct SearchField {
  geometry::Pose room_from_camera;  ///< its middle
  double radius_m = 1.2;
  double radius_rad = 1.2;
};

/// Finds a camera whose pose is not known.
class PoseFinder {
 public:
  virtual ~PoseFinder() = default;
  /// A pose that explains the picture (`explains`); none rather than a guess. `field` says where to
  /// look, where the finder needs it.
  virtual std::optional<PatchFit> find(const GreyPyramid& picture,
                                       const SearchField& field) const = 0;
};

/// Compares a coarse picture with the coarse room at all poses of a grid, by the correlation of
/// grey values along the picture's rays; the best of them are aligned, the best of those down to
/// the finest level. Not thread-safe; allocates.
class FirstPose final : public PoseFinder {
 public:
  /// Map and camera must outlive it.
  FirstPose(const model::Panorama& room, const PatchMap& map, const geometry::AnyCamera& camera,
            const AlignOptions& options, Crew& crew);

  /// The best pose, or none where no pose of the field explains the picture (`explains`),
  /// or another one explains it nearly as well.
  std::optional<PatchFit> find(const GreyPyramid& picture, const SearchField& field) const override;

  /// A place on the coarse room.
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

/// Of the patches that should be seen, those that look and lie as they should; 0 to 1.
double share_of(const PatchFit& fit);
/// Whether patches enough to trust the pose look and lie as they should.
bool explains(const PatchFit& fit);

}  // namespace mixrig::tracking
