// SPDX-License-Identifier: Apache-2.0
// Extrapolates a body's motion.
#pragma once

#include "host/math/geometry/pose.h"

namespace mixrig::geometry {

/// Returns the pose after `share` of the motion from `before` to `last`, in the body's own axes:
/// `last` at 0, `before` at -1, extrapolated beyond `last` above 0.
inline Pose moved_on(const Pose& before, const Pose& last, double share) {
  const Pose motion = inverse(before) * last;
  const Eigen::AngleAxisd turn(motion.rotation);
  return last * Pose{Eigen::Quaterniond(Eigen::AngleAxisd(share * turn.angle(), turn.axis())),
                     share * motion.translation_m};
}

}  // namespace mixrig::geometry
