// SPDX-License-Identifier: Apache-2.0
// The pose between two rooms by robust point-to-plane alignment, and how well it is known. Private
// to this module.
#pragma once

#include <initializer_list>
#include <vector>

#include "host/room/registration/sides.h"

namespace mixrig::model {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// One measure of the fit, in a's axes: distance along the normal, and how that falls with a shift
/// and a turn about b's origin.
struct FitRow {
  Vector6d slope;
  double off_m = 0;
  double sigma_m = 0;            ///< of the distances of both rooms there
  Eigen::Vector3d at_m, normal;  ///< away from the origin of its room
};

/// Of the places on the other room's surface whose number is (held_out) or is not a multiple of
/// three.
std::vector<FitRow> fit_rows(const Sides& sides, const geometry::Pose& a_from_b, double gate_m,
                             bool held_out);

double median_off_m(const std::vector<FitRow>& rows);

/// Gauss-Newton steps at each gate in turn, with Cauchy's weights for 1.5 times the robust sigma,
/// from all places that are not held out. A direction that no surface holds stays where it was.
geometry::Pose refined_pose(const Sides& sides, geometry::Pose a_from_b,
                            std::initializer_list<double> gates_m);

/// Surfaces whose errors are taken as one: planes of either room, elsewhere pieces of two metres
/// that face one way. Returns a number for each row, from 0 without gaps.
std::vector<int> units_of(const std::vector<FitRow>& rows, const std::vector<RoomPlane>& of_a,
                          const std::vector<RoomPlane>& of_b, const geometry::Pose& a_from_b);

struct FitCovariance {
  Matrix6d covariance = Matrix6d::Zero();
  double common_m = 0;  ///< sigma of the error that a unit's places have in common
  double single_m = 0;  ///< robust sigma of a place
};

/// Of the pose that refined_pose() found; `units` are those of units_of(). The error of a place is
/// one of its unit, one of its piece of two metres, both with sigma `common_m`, and one of its own.
/// `common_m` comes from the mean residuals of all units together, by moments (Searle, Casella and
/// McCulloch 1992, section 5), with what the fit took up of them; it is at least 0.3 of the sigma
/// of a distance, since what both scans have wrong in the same way leaves no residual. For the same
/// reason the distance between the rooms is taken as uncertain by `common_m` in 2 m: distances that
/// all are too long make it too long. Both numbers were chosen for errors of studio scans that are
/// as large as the sigma says.
FitCovariance covariance_of(const std::vector<FitRow>& rows, const std::vector<int>& units,
                            const geometry::Pose& a_from_b);

/// How the surfaces hold the pose.
struct Hold {
  Eigen::Vector3d open;  ///< the direction of translation that they hold least
  double share = 0;      ///< of the places, as if their normals lay along `open`
};

/// Without the rows of `left_out` (-1: all count).
Hold hold_of(const std::vector<FitRow>& rows, const std::vector<int>& units, int left_out);

}  // namespace mixrig::model
