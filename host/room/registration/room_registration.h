// SPDX-License-Identifier: Apache-2.0
// Two scanned rooms of the same place, from two positions of the rig, brought into one frame.
#pragma once

#include <optional>
#include <vector>

#include "hal/base/parallel.h"
#include "hal/base/result.h"
#include "host/math/geometry/pose.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

struct RegistrationOptions {
  /// About where b stands: only answers within 0.75 m and 25 degrees of it count.
  std::optional<geometry::Pose> near_a_from_b{};
};

/// Where something stands in the one room that the other sees through.
struct MovedArea {
  bool in_b = false;  ///< directions are those of that room's base
  double azimuth_deg = 0, elevation_deg = 0;
  double square_deg = 0;
};

struct Registration {
  geometry::Pose a_from_b;
  /// Of the translation in metres and a rotation vector about b's origin, both in a's axes.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double sigma_m = 0, sigma_rad = 0;  ///< along the worst axis
  int places = 0;                     ///< that both rooms see
  double overlap_share = 0;           ///< of all places
  double agreeing_share = 0;          ///< of those that both see
  double held_out_m = 0;  ///< median distance from the other's surface; places the fit did not use
  double color_agreement = 0;  ///< correlation of colours, -1..1; 0: one colour
  double least_hold = 0;  ///< share of those that holds the pose along its weakest axis without the
                          ///< one wall that matters most
  double runner_up = 0;   ///< evidence of the second answer over that of the best, 0: there is none
  std::vector<MovedArea> moved;  ///< the largest first, at least 9 square degrees
};

/// Hypotheses from triples of planes of both rooms (room_planes.h) whose normals are in the same
/// angles and which leave the z axes within 25 degrees of each other, and from the floor and one
/// wall with steps along it (a hall). Each is refined by robust point-to-plane alignment in both
/// directions (Chen and Medioni 1992): a place counts where the other origin can see it, one in the
/// other room's free space is evidence against. A third of the places is held out. The covariance
/// is described at covariance_of() (fit.h).
/// Errors, kData: no three planes that are not parallel; overlap below a fifth; less than 70 %
/// agree; the surfaces leave a direction open (a corridor); one wall alone holds a direction (two
/// ends of a hall), or surfaces agree and colours do not, both unless a place is given; another
/// answer, more than 0.1 m or 3 degrees away, has at least 90 % of the evidence (a tenth of a room
/// may have changed) and agrees to within 5 % as well, or overlaps enough and agrees as well, and
/// its colours do not fit worse by three sigma of Fisher's z. Deterministic; depends on nothing but
/// its arguments.
Result<Registration> register_rooms(const Panorama& a, const Panorama& b,
                                    const RegistrationOptions& options, Crew& crew);

}  // namespace mixrig::model
