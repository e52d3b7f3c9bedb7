// SPDX-License-Identifier: Apache-2.0
// Relative motions of two trajectories over a window, and the time offsets at which they correlate.
// Private to this module.
#pragma once

#include <vector>

#include "host/pose/trajectory/align.h"

namespace mixrig::trajectory {

/// Two moments of one trajectory.
struct Window {
  double from_s = 0, to_s = 0;
};

/// Rotation vector and displacement over a window, in the body's axes at its start.
struct Motion {
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
};

/// Pairs of samples about `window_s` apart: no interpolation in this trajectory.
std::vector<Window> windows_of(const Trajectory& trajectory, double window_s);

/// Motion over the window; nullopt where an end lies in a gap.
std::optional<Motion> motion_over(const Trajectory& trajectory, const Window& window);

/// Offsets t_A - t_B where the rotation angles correlate best, best first, by rank correlation
/// over the common time (at least `min_overlap_s`); at most `count`.
struct OffsetCandidate {
  double offset_s = 0;
  double correlation = 0;
};
std::vector<OffsetCandidate> offset_candidates(const Trajectory& a, const Trajectory& b,
                                               const AlignOptions& options, int count);

}  // namespace mixrig::trajectory
