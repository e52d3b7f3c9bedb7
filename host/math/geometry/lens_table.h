// SPDX-License-Identifier: Apache-2.0
// A lens that zooms and focuses: its model as a function of its encoders.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "hal/base/result.h"
#include "host/math/geometry/camera_model.h"
#include "host/math/geometry/pose.h"

namespace mixrig::geometry {

/// Values of a lens's encoders, in their own units.
struct LensEncoders {
  double zoom = 0, focus = 0;
  bool operator==(const LensEncoders&) const = default;
};

/// A lens at one setting. `pupil_shift_m` is how far the entrance pupil, the centre of projection,
/// lies before the origin of the camera's frame, along its z axis.
struct LensState {
  CameraModel camera;
  double pupil_shift_m = 0;
};

/// A calibrated setting of a lens.
struct LensNode {
  LensEncoders at;
  LensState lens;
  double residual_px = 0;  ///< root mean square of its fit; 0 where unknown
};

/// A lens interpolated over a rectangular grid of zoom and focus; focus has one value if only the
/// zoom is calibrated. Between nodes each parameter follows a monotone cubic (Fritsch and Butland
/// 1984) along zoom, then along focus. The interpolated values are the logarithm of the focal
/// length, the ratio fy / fx, the principal point, the shift of the pupil, and each distortion
/// coefficient as its displacement at the corner of the picture: k1 itself grows with the square of
/// the focal length where the displacement hardly changes.
class LensTable {
 public:
  static constexpr std::size_t kMostZooms = 32, kMostFocuses = 8;

  /// Makes a table from nodes in any order. Errors: kData unless they form a full grid of two or
  /// more nodes of one picture size, at most kMostZooms x kMostFocuses, for values that are not
  /// finite, and for a lens that folds inside the picture at a node or midway between nodes.
  static Result<LensTable> make(std::vector<LensNode> nodes);

  /// Returns the lens at these encoder values; outside the table they are clamped to its border
  /// (see contains()). Allocates nothing.
  LensState at(const LensEncoders& encoders) const;
  bool contains(const LensEncoders& encoders) const;
  /// Nodes ordered by zoom, then by focus.
  const std::vector<LensNode>& nodes() const { return nodes_; }
  std::span<const double> zooms() const { return zooms_; }      ///< growing
  std::span<const double> focuses() const { return focuses_; }  ///< growing

 private:
  static constexpr std::size_t kValues = 13;
  using Values = std::array<double, kValues>;
  static Values values_of(const LensState& lens);
  static LensState state_of(const Values& values, Size size_px);
  Result<void> check_between() const;

  std::vector<LensNode> nodes_;
  std::vector<double> zooms_, focuses_;
  std::vector<Values> values_;  ///< values of nodes_
};

/// Returns the largest distance between the pixels at which two lenses of one picture size show a
/// point `z_m` away, over middles and corners of the picture. Used to tell noise from motion.
double largest_shift_px(const LensState& a, const LensState& b, double z_m);

/// Returns the pose of the centre of projection: `world_from_camera` moved along its z axis.
Pose at_pupil(const Pose& world_from_camera, double pupil_shift_m);

}  // namespace mixrig::geometry
