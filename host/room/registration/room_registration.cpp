// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/room_registration.h"

#include <algorithm>
#include <cmath>

#include "host/math/estimation/decompositions.h"
#include "host/room/registration/answers.h"
#include "host/room/registration/fit.h"
#include "host/room/registration/moved.h"
#include "host/room/registration/verdict.h"
#include "host/room/scan/shape/room_planes.h"

namespace mixrig::model {
namespace {

double worst_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, estimation::spectrum_of(covariance).values[2]));
}

}  // namespace

Result<Registration> register_rooms(const Panorama& a, const Panorama& b,
                                    const RegistrationOptions& options, Crew& crew) {
  const std::vector<RoomPlane> of_a = find_planes(a), of_b = find_planes(b);
  const Sides sides = sides_of(a, b, kFineStep_rad);
  std::vector<Answer> answers = find_answers(a, b, of_a, of_b, sides, options, crew);
  const bool is_near = options.near_a_from_b.has_value();
  if (answers.empty())
    return is_near ? refusal("nothing near the given place fits", "give another --near, or none")
                   : refusal("they have no three walls in common that are not parallel",
                             "scan from places that both see a corner of the room");
  order_by_color(answers);
  const Answer& best = answers.front();
  MIXRIG_TRY(check_evidence(best, is_near));
  Registration out;
  out.a_from_b = best.a_from_b;
  const std::vector<FitRow> rows = fit_rows(sides, out.a_from_b, kSurfaceGate_m, false);
  const std::vector<int> units = units_of(rows, of_a, of_b, out.a_from_b);
  MIXRIG_ASSIGN(out.least_hold, check_hold(rows, units, is_near));
  MIXRIG_ASSIGN(out.runner_up, check_rivals(answers));
  out.covariance = covariance_of(rows, units, out.a_from_b).covariance;
  out.sigma_m = worst_sigma(out.covariance.topLeftCorner<3, 3>());
  out.sigma_rad = worst_sigma(out.covariance.bottomRightCorner<3, 3>());
  out.held_out_m = median_off_m(fit_rows(sides, out.a_from_b, kSurfaceGate_m, true));
  out.places = best.evidence.agree + best.evidence.against;
  out.overlap_share = best.evidence.overlap();
  out.agreeing_share = best.evidence.agreeing();
  out.color_agreement = best.color;
  out.moved = moved_areas(sides, out.a_from_b);
  return out;
}

}  // namespace mixrig::model
