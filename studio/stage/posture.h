// SPDX-License-Identifier: Apache-2.0
// The person's motion: joints over time, by scenario and seed.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "studio/stage/mesh.h"
#include "studio/studio.h"

namespace mixrig::studio {

/// Body size; all lengths are multiplied by `scale`, which is 1 for a height of 1.75 m.
struct Build {
  float scale = 1, girth = 1;
  bool long_sleeves = true;
};

/// Angles of one arm, 0 for a hanging arm. Positive: forward, outwards, elbow bent, hand turned
/// inwards.
struct ArmAngles {
  float swing_rad = 0, spread_rad = 0.12F, bend_rad = 0.25F, inward_rad = 0.2F;
};

/// Joint positions and angles that define the body's shape. Index 0 is the left side. World axes.
struct Posture {
  Vec3 pelvis;                        ///< midpoint of the hip joints
  float yaw_rad = 0;                  ///< facing, 0 = world x
  float lean_rad = 0, twist_rad = 0;  ///< of the chest; positive: forward; left shoulder back
  std::array<Vec3, 2> ankles;
  std::array<float, 2> foot_yaw_rad{}, foot_pitch_rad{};  ///< pitch > 0: toes down
  std::array<ArmAngles, 2> arms;
  float head_yaw_rad = 0, head_nod_rad = 0;
  float finger_spread = 0.15F, finger_curl = 0.45F;
};

/// Places of person and object on the floor; chosen by scenario.
struct Stage {
  Eigen::Vector2f object{3.2F, 2.2F};        ///< position of the virtual object
  Eigen::Vector2f path_half_m{0.85F, 1.2F};  ///< half axes of the elliptic path around it
  Eigen::Vector2f spot{2.45F, 2.02F};        ///< position of a person that sits or stands
  float way_in_m = 0;  ///< straight, to the point of the path that is nearest to the camera
};

/// A person's motion over the whole take. Immutable and thread-safe.
class PersonMotion {
 public:
  PersonMotion(Scenario scenario, unsigned seed, const Stage& stage, double start_s);

  /// Whether the person walks, rather than sits or stands.
  bool walks() const;
  /// Time of one lap of the path.
  double lap_s() const { return arc_m_.back() / speed_m_s_; }
  const Build& build() const { return build_; }
  /// A time at which a walking person is in direction (x, y) of the floor from the path's middle.
  double time_towards(double x, double y) const;
  /// Posture at a time of the take; defined for all times.
  Posture at(double time_s) const;

 private:
  struct OnPath {
    Vec3 position;
    float heading_rad;
  };
  OnPath on_path(double distance_m) const;
  OnPath on_lap(double distance_m) const;
  OnPath on_rounds(double distance_m) const;
  Posture walk(double time_s) const;
  Posture stay(double time_s) const;
  void plant_feet(double walked_m, Posture& posture) const;
  void gesture(float time_s, Posture& posture) const;

  Scenario scenario_;
  unsigned seed_;
  Stage stage_;
  Build build_;
  bool seated_ = false;
  double start_s_ = 0, speed_m_s_ = 1.1, stride_m_ = 1.15, start_m_ = 0, turn_ = 1;
  std::vector<double> arc_m_;  ///< arc length of the path at each step of the angle
};

}  // namespace mixrig::studio
