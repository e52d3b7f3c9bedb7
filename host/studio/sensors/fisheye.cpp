// SPDX-License-Identifier: Apache-2.0
// The fisheye picture.
#include "host/studio/sensors/fisheye.h"

#include <cmath>

#include "host/studio/srgb.h"

namespace mixrig::studio {
namespace {

constexpr int kFisheyeBand = 4;
/// Relative to the target camera: short, so that lamps are much brighter than the lit surfaces.
constexpr float kExposure = 0.6F;
constexpr float kFisheyeFullWell_e = 12000, kFisheyeReadNoise_e = 8;

}  // namespace

void add_fisheye_light(const FisheyeOptics& camera, const FisheyeSample& sample,
                       const geometry::Pose& world_from_fisheye, const TraceScene& room,
                       const ShadowCasters& casters, const Materials& materials,
                       const LampSet& lamps, const Light& light, Crew& crew, Image<Rgbf>& sum) {
  const Vec3 eye = world_from_fisheye.translation_m.cast<float>();
  const Eigen::Matrix3f turn = world_from_fisheye.rotation.toRotationMatrix().cast<float>();
  const float exposure = sample.share * kExposure * static_cast<float>(light.exposure);
  const auto shade = [&](const Vec3& ray) -> Vec3 {
    Hit hit, person;
    const bool on_room = room.intersect(eye, ray, kMiss, hit);
    if (casters.person->scene.intersect(eye, ray, on_room ? hit.t : kMiss, person))
      hit = person;
    else if (!on_room)
      return Vec3::Zero();
    const Vec3 position = eye + hit.t * ray;
    const Vec3 albedo = materials.albedo(hit.material, hit.uv, position);
    if (hit.material.kind == Kind::kLamp) return albedo;
    const Vec3 origin = position + kShadowOffset_m * hit.face;
    LampMask open = lamps.facing(origin, hit.normal);
    for (const Occluder* occluder : {casters.furniture, casters.person})
      open = lamps.open(occluder->scene, &occluder->extent, origin, open);
    return albedo.cwiseProduct(light.ambient +
                               lamps.irradiance(origin, hit.normal, open) * lamps.tint());
  };
  crew.rows(camera.size_px.height, kFisheyeBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < camera.size_px.width; ++x) {
        Eigen::Vector3d ray;
        if (!fisheye_ray(camera, x + sample.x_px, y + sample.y_px, ray)) continue;
        const Vec3 lit = exposure * shade(turn * ray.cast<float>());
        Rgbf& out = sum.at(x, y);
        out = {out.r + lit.x(), out.g + lit.y(), out.b + lit.z()};
      }
  });
}

void develop_fisheye(const FisheyeOptics& camera, const Image<Rgbf>& light, std::uint64_t key,
                     const NormalTable& normal, Crew& crew, Image<Rgb8>& picture) {
  picture.reset(camera.size_px);
  crew.rows(camera.size_px.height, kFisheyeBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < camera.size_px.width; ++x) {
        Eigen::Vector3d ray;
        if (!fisheye_ray(camera, x, y, ray)) continue;
        const std::uint64_t bits =
            hash_key(key, static_cast<std::uint64_t>(y) * 65536 + static_cast<unsigned>(x));
        const Rgbf& c = light.at(x, y);
        Vec3 noisy(c.r, c.g, c.b);
        for (int i = 0; i < 3; ++i) {
          const float charge = kFisheyeFullWell_e * noisy[i];
          noisy[i] += std::sqrt(charge + kFisheyeReadNoise_e * kFisheyeReadNoise_e) *
                      normal(bits >> (12 * i)) / kFisheyeFullWell_e;
        }
        picture.at(x, y) = srgb_from_linear(noisy);
      }
  });
}

}  // namespace mixrig::studio
