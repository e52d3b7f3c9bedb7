// SPDX-License-Identifier: Apache-2.0
// Fits the pose between two rooms by robust point-to-plane alignment, with its covariance. Private
// to this module.
#pragma once

#include <initializer_list>
#include <vector>

#include "host/room/registration/sides.h"

namespace mixrig::model {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// One residual of the fit, in a's axes: how far b's surface lies behind a's along the normal, and
/// its derivative by a shift and a turn about b's origin.
struct FitRow {
  Vector6d slope;
  double off_m = 0;
  double sigma_m = 0;            ///< of the distances of both rooms there
  Eigen::Vector3d at_m, normal;  ///< normal: away from the origin of its room
};

/// Rows for places on the other room's surface: with `held_out` those whose number is a multiple of
/// three, else the others.
std::vector<FitRow> fit_rows(const Sides& sides, const geometry::Pose& a_from_b, double gate_m,
                             bool held_out);

double median_off_m(const std::vector<FitRow>& rows);

/// Gauss-Newton steps at each gate in turn, with Cauchy's weights for 1.5 times the robust sigma,
/// over all places that are not held out. A direction that no surface constrains is not changed.
geometry::Pose refined_pose(const Sides& sides, geometry::Pose a_from_b,
                            std::initializer_list<double> gates_m);

/// Groups rows whose errors are taken as one: planes of either room, elsewhere pieces of two metres
/// that face one way. Returns a group number for each row, from 0 without gaps.
std::vector<int> units_of(const std::vector<FitRow>& rows, const std::vector<RoomPlane>& of_a,
                          const std::vector<RoomPlane>& of_b, const geometry::Pose& a_from_b);

struct FitCovariance {
  Matrix6d covariance = Matrix6d::Zero();
  double common_m = 0;  ///< sigma of the error that a unit's places have in common
  double single_m = 0;  ///< robust sigma of a single place
};

/// Covariance of the pose from refined_pose(); `units` are from units_of(). The error of a place is
/// the sum of one of its unit, one of its piece of two metres, both with sigma `common_m`, and one
/// of its own. `common_m` comes from the mean residuals of all units by moments (Searle, Casella
/// and McCulloch 1992, section 5), with what the fit absorbed; it is at least 0.3 of the sigma of a
/// distance, since errors that both scans share leave no residual. For the same reason the distance
/// between the rooms is uncertain by `common_m` in 2 m. Both numbers were chosen for studio scans
/// whose errors are as large as their sigma.
FitCovariance covariance_of(const std::vector<FitRow>& rows, const std::vector<int>& units,
                            const geometry::Pose& a_from_b);

/// How well the surfaces constrain the pose.
struct Hold {
  Eigen::Vector3d open;  ///< direction of translation that they constrain least
  double share = 0;      ///< share of the places, as if their normals lay along `open`
};

/// Computes it without the rows of unit `left_out` (-1: with all).
Hold hold_of(const std::vector<FitRow>& rows, const std::vector<int>& units, int left_out);

}  // namespace mixrig::model
