// SPDX-License-Identifier: Apache-2.0
// How well depth lies on the plate, without truth: where the plate's edges are about depth steps.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "hal/base/image.h"

namespace mixrig::measure {

/// Distances from borders of near surfaces in the depth to the plate's strongest edge along the row
/// or column. Edges of other things lie at every distance alike: as many as at most distances are
/// taken off before the medians.
struct Registration {
  int steps = 0;             ///< borders with an edge near them
  int width_px = 0;          ///< of the pictures
  double matched_share = 0;  ///< of them, more than by chance
  double median_px = 0;      ///< of the distances' sizes
  /// The plate's edges lie so far to the right, below, and outside of the near surface.
  double right_px = 0, down_px = 0, outside_px = 0;
  /// Whether the values mean something.
  bool known() const { return steps >= 1000 && matched_share >= 0.2; }
};

/// Collects pictures of one size. Not thread-safe.
class RegistrationMeasure {
 public:
  /// `depth_m`: z in the view of `plate`, 0 unknown. Precondition: equal sizes.
  void add(ImageView<const float> depth_m, ImageView<const Rgb8> plate);
  Registration result() const;

 private:
  enum Facing { kRight, kLeft, kDown, kUp, kFacings };
  template <typename Depth, typename Gray>
  void scan(int length, const Depth& depth_m, const Gray& gray, Facing ahead, Facing back);

  int reach_px_ = 0, width_px_ = 0;
  /// Counts of offsets -reach_px_..reach_px_ along the axis, by the side that the border faces.
  std::array<std::vector<std::int64_t>, kFacings> offsets_;
};

}  // namespace mixrig::measure
