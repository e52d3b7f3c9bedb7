// SPDX-License-Identifier: Apache-2.0
// Pictures from surfels: light on each, layers in front of each other, one pixel at a time.
#pragma once

#include "host/studio/surfels.h"

namespace mixrig::studio {

/// A scene with the boxes around it.
struct Occluder {
  TraceScene scene;
  Extent extent;

  explicit Occluder(const TraceDevice& device) : scene(device) {}
  void set(Mesh& mesh) {
    scene.set(mesh);
    extent = extent_of(scene.mesh());
  }
};

/// What stands in the light. The room's shell is left out: it is convex and holds everything.
struct Shadowers {
  const Occluder *furniture = nullptr, *object = nullptr, *person = nullptr;
  bool cull = true;  ///< skip rays that cannot meet a scene's box
};

/// What one camera sees of the three scenes.
struct Sight {
  SurfelMap room, object, person;
};

/// Light on a map's surfels from the lamps past furniture and object, and past the person if
/// `with_person`. `with_object` false: `mixed` is left at 0.
void light_surfels(SurfelMap& map, const LampSet& lamps, const Shadowers& shadowers,
                   bool with_object, bool with_person, Crew& crew);

/// Light that the person leaves on a surfel lit without it.
struct Lit {
  float real, mixed;
};
Lit past_person(const Surfel& surfel, const LampSet& lamps, const Shadowers& shadowers);

/// One pixel, box-filtered over its sub-samples. Radiance is linear, before exposure.
struct Pixel {
  Vec3 real, mixed;        ///< without and with the object
  float person = 0;        ///< coverage of the real scene by people
  float silhouette = 0;    ///< coverage by the object, occluded or not
  float light = 1;         ///< luminance of light with / without the object on real surfaces
  std::uint8_t layer = 0;  ///< Truth::kBackground, kPerson or kVirtual: most of the pixel
};
/// `with_object` false leaves mixed, silhouette, light and layer alone.
Pixel compose_pixel(const Sight& sight, int x, int y, const LampSet& lamps, const Vec3& ambient,
                    const Shadowers& shadowers, bool with_object);

}  // namespace mixrig::studio
