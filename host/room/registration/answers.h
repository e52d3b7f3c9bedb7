// SPDX-License-Identifier: Apache-2.0
// Candidate poses between two rooms. Private to this module.
#pragma once

#include <vector>

#include "hal/base/angles.h"
#include "host/room/registration/room_registration.h"
#include "host/room/registration/sides.h"

namespace mixrig::model {

struct Answer {
  geometry::Pose a_from_b;
  Evidence evidence;
  double color = 0;  ///< color_agreement()
};

/// Whether the evidence alone suffices: a fifth of the places is seen by both rooms, 70 % of these
/// agree, and 60 % if places that the other room hides are counted too.
inline constexpr double kLeastOverlap = 0.2, kLeastAgreeing = 0.7, kLeastOfKnown = 0.6;
inline bool is_plausible(const Evidence& e) {
  return e.overlap() >= kLeastOverlap && e.agreeing() >= kLeastAgreeing &&
         e.of_known() >= kLeastOfKnown;
}

/// Candidates from triples of planes, and from the floor and one wall with steps along it, refined;
/// none within 0.1 m and 3 degrees of another, the one with the most evidence first. Candidates
/// with far less evidence are dropped, unless their evidence agrees about as well.
std::vector<Answer> find_answers(const Panorama& a, const Panorama& b,
                                 const std::vector<RoomPlane>& of_a,
                                 const std::vector<RoomPlane>& of_b, const Sides& fine_sides,
                                 const RegistrationOptions& options, Crew& crew);

/// Distance of the places of the fine sides.
inline constexpr double kFineStep_rad = 2 * kDeg;

/// Sorts the first ones by falling value, ties in their order.
void sort_by_color(std::vector<Answer>& answers, std::size_t first_ones);

}  // namespace mixrig::model
