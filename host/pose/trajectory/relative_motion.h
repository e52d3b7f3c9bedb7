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

/// Returns windows between samples about `window_s` apart, so that this trajectory is not
/// interpolated.
std::vector<Window> windows_of(const Trajectory& trajectory, double window_s);

/// Returns the motion over the window; nullopt if an end lies in a gap.
std::optional<Motion> motion_over(const Trajectory& trajectory, const Window& window);

/// A candidate for the offset t_A - t_B. offset_candidates() returns at most `count` of them: those
/// where the rotation angles correlate best, by rank correlation over the common time (at least
/// `min_overlap_s`), best first.
struct OffsetCandidate {
  double offset_s = 0;
  double correlation = 0;
};
std::vector<OffsetCandidate> offset_candidates(const Trajectory& a, const Trajectory& b,
                                               const AlignOptions& options, int count);

}  // namespace mixrig::trajectory
