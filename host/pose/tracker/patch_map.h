// SPDX-License-Identifier: Apache-2.0
// Interest points of a scanned room: small patches of its picture with the place of each pixel.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "hal/base/parallel.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::tracking {

inline constexpr int kPatchSide = 6, kPatchPixels = kPatchSide * kPatchSide;

/// Pixels row by row; u counts columns, v rows. Metres in axes of the panorama. Grey values and
/// gradients of pixels that are not known are 0, and so is their share.
struct Patch {
  using Values = std::array<float, kPatchPixels>;
  Eigen::Vector3f centre_m;
  Eigen::Vector3f normal;          ///< unit, towards the origin
  Values x_m, y_m, z_m;            ///< of each pixel, from the centre
  Values share;                    ///< 1 or 0
  Values grey;                     ///< minus the mean
  Values grey_u, grey_v;           ///< derivatives per pixel, minus their means
  Eigen::Vector3f u_m, v_m;        ///< from a pixel to the next
  float known = 0;                 ///< number of pixels
  float energy = 0;                ///< sum of squares of `grey`
  float uu = 0, uv = 0, vv = 0;    ///< sums of products of the derivatives (Shi and Tomasi 1994)
  float range_m = 0, sigma_m = 0;  ///< distance of the centre from the origin
  float pixel_rad = 0;             ///< from the origin
  float score = 0;                 ///< the smaller eigenvalue, and a little of the larger
};

struct PatchMapOptions {
  /// Finest angle between pixels; that of the camera's picture, or a little less.
  double finest_rad = 0.004;
  int levels = 6;
  int patches = 2500;  ///< of the finest level at most; of the others as their area allows
};

/// What a tracker needs of a room.
struct PatchMap {
  std::vector<std::vector<Patch>> levels;  ///< the finest first; each twice as coarse
  Image<float> distance_m;                 ///< of the panorama, 0 unknown

  /// Whether something of the room stands between the two points: the segment passes behind what is
  /// seen from the panorama's origin, by more than 3 %. What is not known hides nothing, and a map
  /// without a panorama knows nothing.
  bool hidden(const Eigen::Vector3f& eye_m, const Eigen::Vector3f& point_m) const;
};

/// Sets grey values, derivatives and what follows from them, the score too. `grey`: of the pixels
/// with a border of one pixel, row by row, -1 unknown. Pixels whose share is 0 stay unknown.
inline constexpr int kWidePatch = kPatchSide + 2;
void set_look(const std::array<float, kWidePatch * kWidePatch>& grey, Patch& patch);
/// Sets centre, pixels and axes from the places of the pixels whose share is 1; the normal points
/// to `eye_m`. Precondition: one pixel at least.
void set_places(const std::array<Eigen::Vector3d, kPatchPixels>& places_m,
                const Eigen::Vector3d& eye_m, Patch& patch);
/// Whether the grey values differ enough for a patch to be found.
bool has_contrast(const Patch& patch);

/// Patches at places where the picture's gradients determine a shift in both directions (Shi and
/// Tomasi 1994), the best of each of as many cells of equal solid angle. None where the room is not
/// known; on the fine levels none over a depth step.
PatchMap make_patch_map(const model::Panorama& room, const PatchMapOptions& options, Crew& crew);

}  // namespace mixrig::tracking
