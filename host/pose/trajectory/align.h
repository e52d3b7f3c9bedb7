// SPDX-License-Identifier: Apache-2.0
// Aligns two trajectories of one rigid body on two clocks: the offset in time from relative
// rotation angles, the rotation between the bodies from relative rotations, lever arm and scale
// from relative translations (Frahm, Koeser, Grest and Koch 2005, section 5).
#pragma once

#include <optional>
#include <vector>

#include "host/math/estimation/verdict.h"
#include "host/pose/trajectory/trajectory.h"

namespace mixrig::trajectory {

struct AlignOptions {
  double window_s = 0.5;       ///< time over which relative motions are taken
  double min_overlap_s = 4.0;  ///< shorter common time is refused
};

/// p_A = s * a_from_b.rotation * p_B + lever for points fixed to the body.
struct LeverAndScale {
  Eigen::Vector3d lever_m = Eigen::Vector3d::Zero();  ///< origin of body B in body A, A's unit
  double scale = 1;                                   ///< A's unit over B's
};

/// One relative motion: when (A's clock) and how far the aligned rotations disagree.
struct AlignResidual {
  double t_s = 0;
  double angle_rad = 0;
};

struct Alignment {
  double time_offset_s = 0;  ///< t_A = t_B + offset
  double time_offset_sigma_s = 0;
  Eigen::Quaterniond a_from_b = Eigen::Quaterniond::Identity();  ///< R_A_from_B, bodies' axes
  double rotation_sigma_rad = 0;                                 ///< sigma about the worst axis
  double median_residual_rad = 0;
  std::vector<AlignResidual> residuals;
  estimation::Estimate<LeverAndScale> lever_and_scale;  ///< covariance 4x4: lever, scale
};

/// Aligns by relative rotations; for bodies that turn about one axis only, by rotations and
/// epipoles (relative translations) together, which determine the rotation about that axis.
/// Covariance 4x4 of (time offset s, rotation vector rad: a_from_b = exp(w) * estimate), robust to
/// noise that is correlated over the windows (Newey and West 1987). Degenerate: too little common
/// time, a body that hardly turns, or turns about one axis and hardly moves, motions that do not
/// belong together, two offsets that fit equally well. Weak: sigma above 5 ms or 1 deg.
estimation::Estimate<Alignment> align(const Trajectory& a, const Trajectory& b,
                                      const AlignOptions& options = {});

}  // namespace mixrig::trajectory
