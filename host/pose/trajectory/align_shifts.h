// SPDX-License-Identifier: Apache-2.0
// The translations of two trajectories: epipoles, lever arm and scale (Frahm, Koeser, Grest
// and Koch 2005, section 5.2). Private to this module.
#pragma once

#include <optional>

#include "host/pose/trajectory/align_turns.h"

namespace mixrig::trajectory {

/// Solves (1 - R_moving) lever + scale * rotation * shift_fixed = shift_moving over all windows.
/// Covariance 4x4: lever, scale; approximate: overlapping windows count as one.
estimation::Estimate<LeverAndScale> lever_of(const Pair& pair, const State& state);

/// Start of the joint fit of turns and shifts.
struct JointStart {
  State state;
  LeverAndScale lever;
  /// Unit direction along which the lever is not observable; it is not estimated there.
  Eigen::Vector3d unobservable = Eigen::Vector3d::Zero();
};
inline constexpr double kEpipoleSigma_rad = 0.1;
/// Finds the rotation about `axis` (unit, of the fixed body) for bodies that turn about this one
/// axis only. It follows from the epipoles, the directions in which the bodies move, lever arm
/// included. nullopt if its sigma is over kEpipoleSigma_rad.
std::optional<JointStart> turned_by_epipoles(const Pair& pair, const State& state,
                                             const Eigen::Vector3d& axis);

/// Joint fit of turns and shifts, each weighted by its own scatter.
struct JointFit {
  JointStart at;
  /// Covariance of offset, small rotation, lever, scale; robust to noise that is correlated over
  /// the windows (Newey and West 1987). 0 along the unobservable direction of the lever.
  Eigen::Matrix<double, 8, 8> covariance;
};
/// Refines the joint fit; nullopt if it does not converge.
std::optional<JointFit> refine_jointly(const Pair& pair, const JointStart& start);

/// Returns the covariance of (offset, small rotation) from the turns alone, robust to noise that is
/// correlated over the windows.
Eigen::Matrix4d covariance_of(const std::vector<Row>& rows, double window_s);

}  // namespace mixrig::trajectory
