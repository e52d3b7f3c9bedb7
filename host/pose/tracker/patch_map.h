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

/// A small patch of the room's picture. Pixels are stored row by row; u counts columns, v rows.
/// Metres are in axes of the panorama. Grey values and gradients of unknown pixels are 0, and so is
/// their share.
struct Patch {
  using Values = std::array<float, kPatchPixels>;
  Eigen::Vector3f centre_m;
  Eigen::Vector3f normal;          ///< unit, towards the origin
  Values x_m, y_m, z_m;            ///< position of each pixel from the centre
  Values share;                    ///< 1 or 0
  Values grey;                     ///< grey value minus the mean
  Values grey_u, grey_v;           ///< derivatives per pixel, minus their means
  Eigen::Vector3f u_m, v_m;        ///< step from a pixel to the next
  float known = 0;                 ///< number of known pixels
  float energy = 0;                ///< sum of squares of `grey`
  float uu = 0, uv = 0, vv = 0;    ///< sums of products of the derivatives (Shi and Tomasi 1994)
  float range_m = 0, sigma_m = 0;  ///< distance of the centre from the origin
  float pixel_rad = 0;             ///< angle of a pixel from the origin
  float score = 0;                 ///< smaller eigenvalue plus a small part of the larger
};

struct PatchMapOptions {
  /// Finest angle between pixels: that of the camera's picture, or slightly less.
  double finest_rad = 0.004;
  int levels = 6;
  int patches = 2500;  ///< largest number on the finest level; others as their area allows
};

/// The patches and distances of a room, for a tracker.
struct PatchMap {
  std::vector<std::vector<Patch>> levels;  ///< the finest first; each next one twice as coarse
  Image<float> distance_m;                 ///< distances of the panorama; 0 unknown

  /// Whether the room hides one point from the other: the segment passes behind the surface seen
  /// from the panorama's origin by more than 3 %. Unknown parts hide nothing, and without a
  /// panorama nothing is hidden.
  bool hidden(const Eigen::Vector3f& eye_m, const Eigen::Vector3f& point_m) const;
};

inline constexpr int kWidePatch = kPatchSide + 2;
/// Sets grey values, their derivatives and all values computed from them, including the score.
/// `grey`: grey values of the pixels with a border of one pixel, row by row, -1 unknown. Pixels
/// whose share is 0 stay unknown.
void set_look(const std::array<float, kWidePatch * kWidePatch>& grey, Patch& patch);
/// Sets centre, pixels and axes from the positions of the pixels whose share is 1; the normal
/// points towards `eye_m`. Precondition: at least one such pixel.
void set_places(const std::array<Eigen::Vector3d, kPatchPixels>& places_m,
                const Eigen::Vector3d& eye_m, Patch& patch);
/// Whether the grey values differ enough for a patch to be found.
bool has_contrast(const Patch& patch);

/// Makes patches where the picture's gradients determine a shift in both directions (Shi and Tomasi
/// 1994): the best of each of as many cells of equal solid angle. None where the room is unknown;
/// on the fine levels none across a depth step.
PatchMap make_patch_map(const model::Panorama& room, const PatchMapOptions& options, Crew& crew);

}  // namespace mixrig::tracking
