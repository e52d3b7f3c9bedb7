// SPDX-License-Identifier: Apache-2.0
// A body's motion carried on.
#pragma once

#include "host/math/geometry/pose.h"

namespace mixrig::geometry {

/// Where a body is after `share` of the motion that brought it from `before` to `last`, in its own
/// axes: `last` at 0, `before` at -1; past `last` above 0.
inline Pose moved_on(const Pose& before, const Pose& last, double share) {
  const Pose motion = inverse(before) * last;
  const Eigen::AngleAxisd turn(motion.rotation);
  return last * Pose{Eigen::Quaterniond(Eigen::AngleAxisd(share * turn.angle(), turn.axis())),
                     share * motion.translation_m};
}

}  // namespace mixrig::geometry
