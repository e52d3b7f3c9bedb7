// SPDX-License-Identifier: Apache-2.0
// Modulated light that reaches a surface by way of another one.
#pragma once

#include "studio/light/screen_cache.h"
#include "studio/sensors/tof.h"
#include "studio/stage/light.h"
#include "studio/stage/surfels.h"

namespace mixrig::studio {

/// Scene that the light of a ToF camera meets. The light source is at the lens and lights what the
/// picture shows.
struct LitScene {
  const TraceScene* room = nullptr;
  const TraceScene* person = nullptr;  ///< may be null
  const Materials* materials = nullptr;
  const TofSensor* sensor = nullptr;
  geometry::Pose world_from_tof;
};

/// Light that reaches a point by reflection at all surfaces B around it, for albedo 1: the mean
/// over the hemisphere, weighted with the cosine, of albedo_B cos_B / d_B^2, at the phase of the
/// path from B's light source over B to the point. The way back to the camera is not included.
Echo bounced_echo(const LitScene& scene, const Vec3& position, const Vec3& normal, int rays);
/// Reflected light as the camera sees it: with the phase of the way back added.
Echo seen_from(const TofSensor& sensor, const Echo& bounced, float distance_m, float albedo);

/// Bounced light for all pixels, from nodes; those near people are made again for every frame.
class Multipath {
 public:
  void build(const LitScene& scene, const CameraRays& rays, Size size, Crew& crew);
  /// Nodes within reach of a person's box see the person. A scene without a person undoes it.
  void update(const LitScene& scene, const CameraRays& rays, const Bounds& person, Crew& crew);
  Echo at(float u_px, float v_px, const Vec3& position, const Vec3& normal) const {
    return now_.at(u_px, v_px, position, normal);
  }

 private:
  ScreenCache<Echo> still_, now_;
};

}  // namespace mixrig::studio
