// SPDX-License-Identifier: Apache-2.0
// Light by reflection: mirrored by floor, glass and mirror, and one diffuse reflection everywhere.
#pragma once

#include "studio/light/screen_cache.h"
#include "studio/stage/surfels.h"

namespace mixrig::studio {

/// A scene with its bounding boxes.
struct Occluder {
  TraceScene scene;
  Extent extent;

  explicit Occluder(const TraceDevice& device) : scene(device) {}
  void set(Mesh& mesh) {
    scene.set(mesh);
    extent = extent_of(scene.mesh());
  }
};

/// Surfaces that light others by reflection.
struct Reflector {
  const TraceScene* room = nullptr;  ///< with its furniture
  const Occluder *furniture = nullptr, *object = nullptr, *person = nullptr;
  const Materials* materials = nullptr;
  const LampSet* lamps = nullptr;
  Vec3 ambient = Vec3::Zero();  ///< on the other surface, for all light but that of the lamps
  Vec3 eye = Vec3::Zero();
  bool gloss = false;   ///< floor (varnish) and pictures (glass)
  bool mirror = false;  ///< Kind::kMirror
};

/// Share of light that a surface mirrors at an angle, 0 where it does not: Schlick 1994 from 4 % at
/// right angles for varnish and 8 % for glass (both of its surfaces); 85 % for a mirror, 65 % for
/// chrome.
float reflectance(const Reflector& reflector, Kind kind, float cosine);

/// Mirrored room and object of all surfels of a map that mirror. People are added with add_person.
void mirror_surfels(SurfelMap& map, const Reflector& reflector, bool with_object, Crew& crew);
/// Replaces what a person covers of the mirrored radiance.
void add_person(const Reflector& reflector, const Surfel& surfel, Vec3& real, Vec3& mixed);

/// Diffuse light by way of other surfaces, without and with the object.
struct Bounce {
  Vec3 real = Vec3::Zero(), mixed = Vec3::Zero();
  Bounce& operator+=(const Bounce& o) {
    real += o.real, mixed += o.mixed;
    return *this;
  }
  Bounce operator*(float s) const { return {s * real, s * mixed}; }
};
/// Irradiance at a point: the mean of the radiance times pi of what `rays` rays of the hemisphere
/// meet, spread as the cosine. People are met if `people`, but do not shade what is met. The object
/// hides the ambient light too: that is taken from `mixed`, which may be negative.
Bounce bounce_at(const Reflector& reflector, const Vec3& position, const Vec3& normal, int rays,
                 bool people);

/// Radiance times pi that comes along a ray to a point by way of other surfaces: nothing of a lamp.
/// `mixed` is less the ambient light behind the object.
Bounce indirect(const Reflector& reflector, const Vec3& position, const Vec3& direction,
                bool people);

/// Bounced light on what a camera sees of one scene.
class BounceCache {
 public:
  void build(const Reflector& reflector, const TraceScene& scene, const CameraRays& rays,
             const Optics& optics, const geometry::Pose& world_from_camera, bool dense, bool people,
             Crew& crew);
  Bounce at(const Vec3& position, const Vec3& normal) const;
  /// Mean over all nodes, without the object.
  Vec3 mean() const;

 private:
  ScreenCache<Bounce> nodes_;
  Optics optics_;
  geometry::Pose camera_from_world_;
};
/// Sets the bounced light of all surfels of a map.
void bounce_surfels(SurfelMap& map, const BounceCache& cache, Crew& crew);

}  // namespace mixrig::studio
