// SPDX-License-Identifier: Apache-2.0
// Data of one frame about people and virtual objects.
#pragma once

#include <span>

#include "extras/people/plan/people_tracker.h"
#include "host/math/geometry/depth_noise.h"
#include "host/math/geometry/pose.h"

namespace mixrig::touch {

struct Moment {
  plan::SegmentedView seen;
  std::span<const plan::Person> people;               ///< people with their surface in this frame
  std::span<const geometry::Pose> world_from_object;  ///< one a shape; empty: not shown
  geometry::DepthNoise noise;                         ///< noise of a depth value
  double time_s = 0;
};

}  // namespace mixrig::touch
