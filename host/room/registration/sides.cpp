// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/sides.h"

#include <cmath>
#include <utility>

namespace mixrig::model {

using Eigen::Vector3d;

Sides sides_of(const Panorama& a, const Panorama& b, double step_rad) {
  return {Side{&a, places_of(b, step_rad), true}, Side{&b, places_of(a, step_rad), false}};
}

Evidence evidence_of(const Sides& sides, const geometry::Pose& a_from_b, double gate_m) {
  Evidence e;
  look_all(sides, a_from_b, gate_m,
           [&](const Side&, std::size_t, const Vector3d&, const Vector3d&, const Seen& seen) {
             ++e.places;
             e.agree += seen.sight == RoomSight::kAgrees;
             e.against += seen.sight == RoomSight::kAgainst;
             e.hidden += seen.sight == RoomSight::kHidden;
           });
  return e;
}

double color_agreement(const Sides& sides, const geometry::Pose& a_from_b) {
  std::vector<std::array<Eigen::Vector3f, 2>> pairs;
  Vector3d mean0(0, 0, 0), mean1(0, 0, 0);
  look_all(sides, a_from_b, kSurfaceGate_m,
           [&](const Side& side, std::size_t i, const Vector3d&, const Vector3d&, const Seen& s) {
             if (s.sight != RoomSight::kAgrees) return;
             Eigen::Vector3f own = side.places[i].color, other = s.color;
             if (own.isZero() || other.isZero()) return;
             if (side.of_b) std::swap(own, other);
             pairs.push_back({own, other});
             mean0 += own.cast<double>(), mean1 += other.cast<double>();
           });
  if (pairs.size() < 10) return 0;
  const double n = static_cast<double>(pairs.size());
  mean0 /= n, mean1 /= n;
  double s00 = 0, s11 = 0, s01 = 0;
  for (const auto& [p, q] : pairs) {
    const Vector3d u = p.cast<double>() - mean0, v = q.cast<double>() - mean1;
    s00 += u.squaredNorm(), s11 += v.squaredNorm(), s01 += u.dot(v);
  }
  constexpr double kOneColor = 1;  // variance, in bytes^2
  return s00 < kOneColor * n || s11 < kOneColor * n ? 0 : s01 / std::sqrt(s00 * s11);
}

}  // namespace mixrig::model
