// SPDX-License-Identifier: Apache-2.0
// Light by reflection: mirrored by floor, glass and mirror, and one diffuse reflection everywhere.
#include "studio/light/reflection.h"

#include <array>
#include <cmath>

namespace mixrig::studio {
namespace {

constexpr int kReflectionBand = 4;
constexpr int kRays = 64, kFewRays = 32;
/// Slopes of varnish across the mirrored ray; the mean of these rays is what is seen in it.
constexpr std::array<std::array<float, 2>, 4> kSlopes{
    {{-0.02F, -0.035F}, {0.035F, -0.02F}, {0.02F, 0.035F}, {-0.035F, 0.02F}}};

/// Radiance (times pi, for diffuse surfaces) that leaves a surface, with the shadows of furniture
/// and, if `with_object`, of the object.
Vec3 leaving(const Reflector& r, const Hit& hit, const Vec3& at, bool with_object) {
  const Vec3 albedo = r.materials->albedo(hit.material, hit.uv, at);
  if (hit.material.kind == Kind::kLamp) return albedo;
  const Vec3 origin = at + kShadowOffset_m * hit.face;
  LampMask open = r.lamps->facing(origin, hit.normal);
  open = r.lamps->open_middle(r.furniture->scene, origin, open);
  if (with_object) open = r.lamps->open_middle(r.object->scene, origin, open);
  return albedo.cwiseProduct(r.ambient +
                             r.lamps->irradiance(origin, hit.normal, open) * r.lamps->tint());
}

/// Surface that a ray meets, without and with the object, which hides `behind_object`.
Bounce met(const Reflector& r, const Vec3& origin, const Vec3& direction, bool people,
           const Vec3& behind_object = Vec3::Zero()) {
  Hit hit, other;
  bool any = r.room->intersect(origin, direction, kMiss, hit);
  if (people && r.person->scene.intersect(origin, direction, any ? hit.t : kMiss, other))
    hit = other, any = true;
  Bounce b;
  if (any) {
    const Vec3 at = origin + hit.t * direction;
    b.real = leaving(r, hit, at, false);
    b.mixed = leaving(r, hit, at, true);
  }
  if (r.object->scene.intersect(origin, direction, any ? hit.t : kMiss, other))
    b.mixed = leaving(r, other, origin + other.t * direction, true) - behind_object;
  return b;
}

Vec3 mirrored(const Vec3& direction, const Vec3& normal) {
  return direction - 2 * direction.dot(normal) * normal;
}

/// The rays that make up a surfel's mirror image.
int mirror_rays(const Reflector& r, const Surfel& s, std::array<Vec3, 4>& rays) {
  const Vec3 out = mirrored((s.origin - r.eye).normalized(), s.normal);
  if (s.kind != Kind::kFloor) {
    rays[0] = out;
    return 1;
  }
  for (std::size_t i = 0; i < 4; ++i)
    rays[i] = (out + Vec3(kSlopes[i][0], kSlopes[i][1], 0)).normalized();
  return 4;
}

/// Whether a ray can hit a box.
bool can_hit(const Bounds& box, const Vec3& origin, const Vec3& direction) {
  float from = 0, to = kMiss;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(direction[i]) < 1e-7F) {
      if (origin[i] < box.low[i] || origin[i] > box.high[i]) return false;
      continue;
    }
    const float a = (box.low[i] - origin[i]) / direction[i];
    const float b = (box.high[i] - origin[i]) / direction[i];
    from = std::max(from, std::min(a, b)), to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

}  // namespace

float reflectance(const Reflector& reflector, Kind kind, float cosine) {
  if (kind == Kind::kMirror) return reflector.mirror ? 0.85F : 0.0F;
  if (kind == Kind::kChrome) return reflector.gloss ? 0.65F : 0.0F;
  const float least = kind == Kind::kFloor ? 0.04F : kind == Kind::kPoster ? 0.08F : 0.0F;
  if (least == 0 || !reflector.gloss) return 0;
  return least + (1 - least) * std::pow(1 - std::min(std::abs(cosine), 1.0F), 5.0F);
}

void mirror_surfels(SurfelMap& map, const Reflector& r, bool with_object, Crew& crew) {
  const Rect rect = map.rect();
  crew.rows(std::max(0, rect.y1 - rect.y0), kReflectionBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (Surfel& s : map.row(rect.y0 + y)) {
        if (s.z == kMiss) continue;
        const float cosine = (r.eye - s.origin).normalized().dot(s.normal);
        s.reflectance = reflectance(r, s.kind, cosine);
        if (s.reflectance == 0) continue;
        std::array<Vec3, 4> rays;
        const int count = mirror_rays(r, s, rays);
        Bounce sum;
        for (int i = 0; i < count; ++i)
          sum += met(r, s.origin, rays[static_cast<std::size_t>(i)], false);
        const float scale = s.reflectance / static_cast<float>(count);
        s.gloss_real = scale * sum.real;
        s.gloss_mixed = with_object ? Vec3(scale * sum.mixed) : s.gloss_real;
      }
  });
}

void add_person(const Reflector& r, const Surfel& s, Vec3& real, Vec3& mixed) {
  if (r.person->scene.empty()) return;
  std::array<Vec3, 4> rays;
  const int count = mirror_rays(r, s, rays);
  const float share = 1 / static_cast<float>(count);
  Vec3 in_front_real = Vec3::Zero(), in_front_mixed = Vec3::Zero();
  float free_real = 1, free_mixed = 1;
  for (int i = 0; i < count; ++i) {
    const Vec3& ray = rays[static_cast<std::size_t>(i)];
    Hit hit, other;
    if (!can_hit(r.person->extent.whole, s.origin, ray) ||
        !r.person->scene.intersect(s.origin, ray, kMiss, hit) ||
        r.furniture->scene.intersect(s.origin, ray, hit.t, other))
      continue;
    const Vec3 at = s.origin + hit.t * ray;
    in_front_real += share * s.reflectance * leaving(r, hit, at, false);
    free_real -= share;
    if (r.object->scene.intersect(s.origin, ray, hit.t, other)) continue;
    in_front_mixed += share * s.reflectance * leaving(r, hit, at, true);
    free_mixed -= share;
  }
  real = free_real * real + in_front_real;
  mixed = free_mixed * mixed + in_front_mixed;
}

Bounce indirect(const Reflector& reflector, const Vec3& position, const Vec3& direction,
                bool people) {
  Hit lamp;
  // The lamps' own light is counted elsewhere.
  if (reflector.room->intersect(position, direction, kMiss, lamp) &&
      lamp.material.kind == Kind::kLamp)
    return {};
  return met(reflector, position, direction, people, reflector.ambient);
}

Bounce bounce_at(const Reflector& reflector, const Vec3& position, const Vec3& normal, int rays,
                 bool people) {
  Bounce sum;
  for (int i = 0; i < rays; ++i)
    sum += indirect(reflector, position, hemisphere_direction(normal, i, rays), people);
  return sum * (1 / static_cast<float>(rays));
}

void BounceCache::build(const Reflector& reflector, const TraceScene& scene, const CameraRays& rays,
                        const Optics& optics, const geometry::Pose& world_from_camera, bool dense,
                        bool people, Crew& crew) {
  optics_ = optics;
  camera_from_world_ = geometry::inverse(world_from_camera);
  const int step = std::max(dense ? 4 : 8, optics.size_px.width / (dense ? 80 : 40));
  nodes_.reset(optics.size_px, step, optics.size_px.width / 8);
  nodes_.build(crew, [&](float u, float v, CacheNode<Bounce>& node) {
    Hit hit;
    const Vec3 direction = rays.direction(u, v);
    if (!scene.intersect(rays.position, direction, kMiss, hit)) return;
    node.position = rays.position + hit.t * direction;
    node.normal = hit.normal;
    node.value = bounce_at(reflector, node.position + kShadowOffset_m * hit.face, hit.normal,
                           dense ? kRays : kFewRays, people);
  });
}

Bounce BounceCache::at(const Vec3& position, const Vec3& normal) const {
  const Eigen::Vector3d p = camera_from_world_ * position.cast<double>();
  const Eigen::Vector2f px = project(optics_, p).cast<float>();
  return nodes_.at(px.x(), px.y(), position, normal);
}

Vec3 BounceCache::mean() const {
  Vec3 sum = Vec3::Zero();
  float count = 0;
  for (const CacheNode<Bounce>& node : nodes_.nodes())
    if (!node.normal.isZero()) sum += node.value.real, count += 1;
  return count > 0 ? Vec3(sum / count) : sum;
}

void bounce_surfels(SurfelMap& map, const BounceCache& cache, Crew& crew) {
  const Rect rect = map.rect();
  crew.rows(std::max(0, rect.y1 - rect.y0), kReflectionBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (Surfel& s : map.row(rect.y0 + y)) {
        if (s.z == kMiss || s.glows) continue;
        const Bounce b = cache.at(s.origin, s.normal);
        s.bounce_real = b.real, s.bounce_mixed = b.mixed;
      }
  });
}

}  // namespace mixrig::studio
