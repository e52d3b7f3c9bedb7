// SPDX-License-Identifier: Apache-2.0
// Pictures from surfels: lighting, and composition of the layers pixel by pixel.
#pragma once

#include "studio/light/reflection.h"

namespace mixrig::studio {

/// The scenes that cast shadows. The room's shell is not among them: it is convex and contains
/// everything.
struct ShadowCasters {
  const Occluder *furniture = nullptr, *object = nullptr, *person = nullptr;
  bool cull = true;                      ///< skip rays that cannot hit a scene's boxes
  const Reflector* reflector = nullptr;  ///< null: nothing is mirrored
};

/// The three scenes as seen by one camera.
struct SceneSurfels {
  SurfelMap room, object, person;
};

/// Computes the lamp light on a map's surfels with the shadows of furniture, of the object if
/// `with_object`, and of the person if `with_person`. Without the object `mixed` equals `real`.
void light_surfels(SurfelMap& map, const LampSet& lamps, const ShadowCasters& casters,
                   bool with_object, bool with_person, Crew& crew);

/// Lamp light on a surfel, without and with the object.
struct LampLight {
  float real, mixed;
  Vec3 gloss_real = Vec3::Zero(), gloss_mixed = Vec3::Zero();
};
/// Adds the person's shadow to a surfel that was lit without it.
LampLight with_person_shadow(const Surfel& surfel, const LampSet& lamps,
                             const ShadowCasters& casters);

/// One pixel, box-filtered over its sub-samples. Radiance is linear, before exposure.
struct Pixel {
  Vec3 real, mixed;      ///< without and with the virtual object
  float person = 0;      ///< coverage of the real scene by people
  float silhouette = 0;  ///< coverage by the object, occluded or not
  float light = 1;       ///< luminance of the light on real surfaces with / without the object
  /// Truth::kBackground, kPerson or kVirtual: the layer with most sub-samples.
  std::uint8_t layer = 0;
};
/// Composes one pixel. Without `with_object`, silhouette, light and layer keep their defaults and
/// mixed is zero.
Pixel compose_pixel(const SceneSurfels& surfels, int x, int y, const LampSet& lamps,
                    const Vec3& ambient, const ShadowCasters& casters, bool with_object);

/// The person of `surfels` before a pixel of the room whose radiance is `behind`.
Vec3 with_person(const SceneSurfels& surfels, int x, int y, const LampSet& lamps,
                 const Vec3& ambient, const ShadowCasters& casters, const Vec3& behind);

}  // namespace mixrig::studio
