// SPDX-License-Identifier: Apache-2.0
// Registers two scanned rooms of the same place, from two positions of the rig.
#pragma once

#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "hal/base/result.h"
#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

struct RegistrationOptions {
  /// Approximate pose of b: only answers within 0.75 m and 25 degrees of it count.
  std::optional<geometry::Pose> near_a_from_b{};
};

/// An area where something stands in one room and the other room sees through it.
struct MovedArea {
  bool in_b = false;  ///< directions are in base axes of b, else of a
  double azimuth_deg = 0, elevation_deg = 0;
  double square_deg = 0;
};

struct Registration {
  geometry::Pose a_from_b;
  /// Covariance of the translation in metres and a rotation vector about b's origin, in a's axes.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double sigma_m = 0, sigma_rad = 0;  ///< along the worst axis
  int places = 0;                     ///< number of places that both rooms see
  double overlap_share = 0;           ///< share of all places
  double agreeing_share = 0;          ///< share of the places that both see
  /// Median distance from the other's surface, over places not used by the fit.
  double held_out_m = 0;
  double color_agreement = 0;  ///< correlation of colours, -1..1; 0: a single colour
  double least_hold = 0;       ///< share of those places that constrains the pose along its weakest
                               ///< axis, without the most important wall
  /// Evidence of the second-best answer over that of the best; 0: there is none.
  double runner_up = 0;
  std::vector<MovedArea> moved;  ///< at least 9 square degrees each, the largest first
};

/// Registers b to a. Hypotheses come from triples of planes of both rooms (room_planes.h) whose
/// normals enclose the same angles and which keep the z axes within 25 degrees, and from the floor
/// and one wall with steps along it (a hall). Each is refined by robust point-to-plane alignment in
/// both directions (Chen and Medioni 1992): a place counts where the other origin can see it, and a
/// place in the other room's free space is evidence against. A third of the places is held out.
/// covariance_of() (fit.h) describes the covariance.
/// Errors, kData: no three non-parallel planes; overlap below a fifth; less than 70 % agree; the
/// surfaces leave a direction open (a corridor); only one wall constrains a direction (two ends of
/// a hall), or surfaces agree and colours do not, both unless a place is given; another answer,
/// more than 0.1 m or 3 degrees away, has at least 90 % of the evidence (a tenth of a room may have
/// changed) and agrees to within 5 %, or overlaps enough and agrees as well, and its colours are
/// not worse by three sigma of Fisher's z. Deterministic.
Result<Registration> register_rooms(const Panorama& a, const Panorama& b,
                                    const RegistrationOptions& options, Crew& crew);

}  // namespace mixrig::model
