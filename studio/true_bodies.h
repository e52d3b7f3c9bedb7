// SPDX-License-Identifier: Apache-2.0
// The true surfaces of the people of a take, without rendering it: who touches what, and when.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "host/math/geometry/pose.h"
#include "studio/studio.h"

namespace mixrig::studio {

/// Signed distance and position of the surface point that is nearest to a box, or deepest in it.
struct BoxDistance {
  double m = 0;  ///< negative: inside, the distance to the nearest face
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  ///< world
};

class TrueBodies {
 public:
  static constexpr float kSpacing_m = 0.02F;  ///< of the points in which surfaces are sampled

  /// Valid options of a take, not of a sweep.
  explicit TrueBodies(const StudioOptions& options);
  ~TrueBodies();
  TrueBodies(const TrueBodies&) = delete;
  TrueBodies& operator=(const TrueBodies&) = delete;

  /// Points of the surface of each person at mid-exposure of a frame, which may lie between two;
  /// world. Who is not in the room yet has points too: from the first frame with people on they
  /// count.
  std::vector<std::vector<Eigen::Vector3f>> surfaces(double frame) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Precondition: there is a point. Pure.
BoxDistance distance_to_box(const std::vector<Eigen::Vector3f>& surface_m,
                            const geometry::Pose& world_from_box, const Eigen::Vector3d& half_m);

}  // namespace mixrig::studio
