// SPDX-License-Identifier: Apache-2.0
// Mutual evidence of two rooms under a pose. Private to this module.
#pragma once

#include <array>
#include <vector>

#include "host/math/geometry/pose.h"
#include "host/room/registration/places.h"
#include "host/room/scan/panorama/panorama.h"

namespace mixrig::model {

/// Largest distance from the other room's surface at which a place counts as on it.
inline constexpr double kSurfaceGate_m = 0.02;

/// Places of one room, to be looked up in the other room's panorama.
struct Side {
  const Panorama* panorama;       ///< the panorama to look in
  std::vector<RoomPlace> places;  ///< of the other room
  bool of_b = false;              ///< whether the places are of b
};
using Sides = std::array<Side, 2>;

/// Places of b for a's panorama, and of a for b's, about `step_rad` apart.
Sides sides_of(const Panorama& a, const Panorama& b, double step_rad);

/// Pose from the axes of the places to those of the panorama.
inline geometry::Pose to_other(const Side& side, const geometry::Pose& a_from_b) {
  return side.of_b ? a_from_b : geometry::inverse(a_from_b);
}

/// Counts of places. Shares are 0 if there is nothing to count.
struct Evidence {
  int places = 0, agree = 0, against = 0, hidden = 0;
  double of_all() const { return share(agree - against, places); }
  double overlap() const { return share(agree + against, places); }
  double agreeing() const { return share(agree, agree + against); }
  double of_known() const { return share(agree, agree + against + hidden); }

 private:
  static double share(int part, int whole) { return whole > 0 ? 1.0 * part / whole : 0; }
};

Evidence evidence_of(const Sides& sides, const geometry::Pose& a_from_b, double gate_m);

/// Correlation of the colours of places with the other room's colours there, each channel around
/// its mean. 0 if either has a single colour.
double color_agreement(const Sides& sides, const geometry::Pose& a_from_b);

/// Calls body(side, index of the place, position and normal in the other room, Seen) for every
/// place of both sides.
template <typename Body>
void look_all(const Sides& sides, const geometry::Pose& a_from_b, double gate_m, const Body& body) {
  for (const Side& side : sides) {
    const geometry::Pose pose = to_other(side, a_from_b);
    const Eigen::Matrix3d turn = pose.rotation.toRotationMatrix();
    for (std::size_t i = 0; i < side.places.size(); ++i) {
      const RoomPlace& place = side.places[i];
      const Eigen::Vector3d at_m = turn * place.at_m + pose.translation_m;
      const Eigen::Vector3d normal = turn * place.normal;
      body(side, i, at_m, normal, look(*side.panorama, at_m, normal, place.sigma_m, gate_m));
    }
  }
}

}  // namespace mixrig::model
