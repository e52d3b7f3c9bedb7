// SPDX-License-Identifier: Apache-2.0
// Modulated light that reaches a surface by way of another one.
#include "studio/sensors/multipath.h"

#include <cmath>
#include <numbers>

namespace mixrig::studio {
namespace {

constexpr int kStep_px = 4, kBounceRays = 64;
constexpr float kBounceReach_m = 0.8F;  ///< from a person's box, within which its light is followed

float phase_per_path_m(double frequency_hz) {
  return static_cast<float>(2 * std::numbers::pi * frequency_hz / 299792458.0);
}

/// Nearest surface along a ray.
bool nearest(const LitScene& scene, const Vec3& origin, const Vec3& direction, Hit& hit) {
  bool any = scene.room->intersect(origin, direction, kMiss, hit);
  Hit other;
  if (scene.person != nullptr &&
      scene.person->intersect(origin, direction, any ? hit.t : kMiss, other))
    hit = other, any = true;
  return any;
}

bool is_open(const LitScene& scene, const Vec3& from, const Vec3& to) {
  return !scene.room->blocked(from, to) &&
         (scene.person == nullptr || !scene.person->blocked(from, to));
}

/// Whether the light source lights a direction: the picture and a tenth around it.
bool lit(const LitScene& scene, const Vec3& from_eye) {
  const Vec3 p = scene.world_from_tof.rotation.cast<float>().conjugate() * from_eye;
  const Optics& o = scene.sensor->optics;
  const auto half_x = static_cast<float>(0.55 * o.size_px.width / o.fx_px);
  const auto half_y = static_cast<float>(0.55 * o.size_px.height / o.fy_px);
  return p.z() > 0 && std::abs(p.x()) < half_x * p.z() && std::abs(p.y()) < half_y * p.z();
}

void see(const LitScene& scene, const CameraRays& rays, float u, float v, CacheNode<Echo>& node) {
  Hit hit;
  const Vec3 direction = rays.direction(u, v);
  if (!nearest(scene, rays.position, direction, hit)) {
    node = {};
    return;
  }
  node.position = rays.position + hit.t * direction;
  node.normal = hit.normal;
  node.value =
      bounced_echo(scene, node.position + kShadowOffset_m * hit.face, node.normal, kBounceRays);
}

/// Turns an echo's phases by the way of `path_m`.
Echo turned(const TofSensor& sensor, const Echo& e, float path_m, float scale) {
  const auto turn = [&](double hz, float c, float s, float& to_c, float& to_s) {
    const float phase = phase_per_path_m(hz) * path_m;
    to_c = scale * (c * std::cos(phase) - s * std::sin(phase));
    to_s = scale * (s * std::cos(phase) + c * std::sin(phase));
  };
  Echo out;
  turn(sensor.fine_hz, e.fine_cos, e.fine_sin, out.fine_cos, out.fine_sin);
  if (sensor.coarse_hz > 0)
    turn(sensor.coarse_hz, e.coarse_cos, e.coarse_sin, out.coarse_cos, out.coarse_sin);
  if (sensor.third_hz > 0)
    turn(sensor.third_hz, e.third_cos, e.third_sin, out.third_cos, out.third_sin);
  out.strength = scale * e.strength;
  return out;
}

}  // namespace

Echo bounced_echo(const LitScene& scene, const Vec3& position, const Vec3& normal, int rays) {
  const Vec3 eye = scene.world_from_tof.translation_m.cast<float>();
  Echo sum;
  for (int i = 0; i < rays; ++i) {
    Hit hit;
    const Vec3 direction = hemisphere_direction(normal, i, rays);
    if (!nearest(scene, position, direction, hit)) continue;
    const Vec3 at = position + hit.t * direction, to_eye = eye - at;
    const float d = to_eye.norm(), cosine = hit.normal.dot(to_eye) / d;
    if (cosine <= 0 || !lit(scene, -to_eye)) continue;
    if (!is_open(scene, at + kShadowOffset_m * hit.face, eye)) continue;
    const Vec3 visible = scene.materials->albedo(hit.material, hit.uv, at);
    Echo one;
    one.fine_cos = one.coarse_cos = one.third_cos = one.strength =
        scene.materials->infrared(hit.material, visible) * cosine / (d * d);
    sum += turned(*scene.sensor, one, hit.t + d, 1);
  }
  return sum * (1 / static_cast<float>(rays));
}

Echo seen_from(const TofSensor& sensor, const Echo& bounced, float distance_m, float albedo) {
  return turned(sensor, bounced, distance_m, albedo);
}

void Multipath::build(const LitScene& scene, const CameraRays& rays, Size size, Crew& crew) {
  still_.reset(size, kStep_px, 0);
  still_.build(crew,
               [&](float u, float v, CacheNode<Echo>& node) { see(scene, rays, u, v, node); });
  now_ = still_;
}

void Multipath::update(const LitScene& scene, const CameraRays& rays, const Bounds& person,
                       Crew& crew) {
  now_ = still_;
  if (scene.person == nullptr || scene.person->empty()) return;
  const Vec3 reach = Vec3::Constant(kBounceReach_m);
  const Vec3 low = person.low - reach, high = person.high + reach;
  now_.build(crew, [&](float u, float v, CacheNode<Echo>& node) {
    Hit hit;
    const bool near =
        (node.position.array() > low.array()).all() && (node.position.array() < high.array()).all();
    if (near || scene.person->intersect(rays.position, rays.direction(u, v), kMiss, hit))
      see(scene, rays, u, v, node);
  });
}

}  // namespace mixrig::studio
