// SPDX-License-Identifier: Apache-2.0
#include "studio/light/object_gloss.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "hal/base/angles.h"

namespace mixrig::studio {
namespace {

constexpr int kObjectBand = 4, kGlossRays = 48;
constexpr float kAtRightAngles = 0.04F;

/// A surface of microfacets, seen from one side.
struct Facets {
  float width2 = 1;  ///< square of GGX's width
  Vec3 normal, to_eye;
  float eye = 1;  ///< cosine

  static float fresnel(float cosine) {
    return kAtRightAngles +
           (1 - kAtRightAngles) * std::pow(1 - std::clamp(cosine, 0.0F, 1.0F), 5.0F);
  }
  /// Smith's shadowing and masking, correlated by height.
  float open(float light) const {
    const float a = light * std::sqrt(width2 + (1 - width2) * eye * eye);
    const float b = eye * std::sqrt(width2 + (1 - width2) * light * light);
    return 2 * light * eye / (a + b);
  }
  /// Radiance by an irradiance of pi from a direction, over the light's cosine.
  float mirrored(const Vec3& to_light) const {
    const float light = normal.dot(to_light);
    if (!(light > 0)) return 0;
    const Vec3 half = (to_light + to_eye).normalized();
    const float n = normal.dot(half), bulk = n * n * (width2 - 1) + 1;
    return width2 / (bulk * bulk) * open(light) / (4 * light * eye);
  }
  /// The normal of facet i of n, spread as GGX's.
  Vec3 facet(int i, int n) const {
    constexpr float kGolden_rad = 2.39996323F;
    const float share = (static_cast<float>(i) + 0.5F) / static_cast<float>(n);
    const float up = std::sqrt((1 - share) / (1 + (width2 - 1) * share));
    const float side = std::sqrt(std::max(0.0F, 1 - up * up)),
                turn = kGolden_rad * static_cast<float>(i);
    const Vec3 other = std::abs(normal.z()) < 0.9F ? Vec3::UnitZ() : Vec3::UnitX();
    const Vec3 x = other.cross(normal).normalized(), y = normal.cross(x);
    return side * std::cos(turn) * x + side * std::sin(turn) * y + up * normal;
  }
};

/// Light of the lamps' visible points: mirrored, less what no longer reaches the colour below.
Vec3 of_lamps(const Facets& facets, const Surfel& s, const LampSet& lamps) {
  float mirrored = 0, kept = 0;
  lamps.each_open(s.origin, s.normal, s.open_mixed, [&](const Vec3& to_lamp, float irradiance) {
    const float share = Facets::fresnel(facets.to_eye.dot((to_lamp + facets.to_eye).normalized()));
    mirrored += irradiance * share * facets.mirrored(to_lamp);
    kept += irradiance * share;
  });
  return mirrored * lamps.tint() - kept * s.albedo.cwiseProduct(lamps.tint());
}

Vec3 of_room(const Facets& facets, const Surfel& s, const Reflector& r, bool bounce) {
  Vec3 mirrored = Vec3::Zero();
  float all = 0;
  for (int i = 0; i < kGlossRays; ++i) {
    const Vec3 half = facets.facet(i, kGlossRays);
    const float at = facets.to_eye.dot(half);
    const Vec3 ray = 2 * at * half - facets.to_eye;
    const float light = s.normal.dot(ray);
    if (!(light > 0) || !(at > 0)) continue;
    const float share = Facets::fresnel(at) * facets.open(light) * at /
                        (facets.eye * s.normal.dot(half)) / kGlossRays;
    all += share;
    mirrored += share * r.ambient;
    if (bounce) mirrored += share * indirect(r, s.origin, ray, false).mixed;
  }
  return mirrored - all * s.albedo.cwiseProduct(r.ambient + s.bounce_mixed);
}

}  // namespace

void gloss_object(SurfelMap& map, const Reflector& reflector, const LampSet& lamps,
                  const VirtualObject& object, bool bounce, Crew& crew) {
  const Rect rect = map.rect();
  const float width = std::pow(object.meshes.front().roughness, 2.0F);
  crew.rows(std::max(0, rect.y1 - rect.y0), kObjectBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (Surfel& s : map.row(rect.y0 + y)) {
        if (s.z == kMiss) continue;
        Facets facets{width * width, s.normal, (reflector.eye - s.origin).normalized()};
        facets.eye = std::max(1e-3F, s.normal.dot(facets.to_eye));
        s.gloss_real = s.gloss_mixed =
            of_lamps(facets, s, lamps) + of_room(facets, s, reflector, bounce);
      }
  });
}

}  // namespace mixrig::studio
