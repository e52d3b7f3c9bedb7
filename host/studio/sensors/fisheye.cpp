// SPDX-License-Identifier: Apache-2.0
// The fisheye picture.
#include "host/studio/sensors/fisheye.h"

#include "host/studio/srgb.h"

namespace mixrig::studio {
namespace {

constexpr int kFisheyeBand = 4;
/// Relative to the target camera: short, so that lamps are much brighter than the lit surfaces.
constexpr float kExposure = 0.6F;

}  // namespace

void draw_fisheye(const FisheyeOptics& camera, const geometry::Pose& world_from_fisheye,
                  const TraceScene& room, const ShadowCasters& casters, const Materials& materials,
                  const LampSet& lamps, const Light& light, Crew& crew, Image<Rgb8>& picture) {
  picture.reset(camera.size_px);
  const Vec3 eye = world_from_fisheye.translation_m.cast<float>();
  const Eigen::Matrix3f turn = world_from_fisheye.rotation.toRotationMatrix().cast<float>();
  const float exposure = kExposure * static_cast<float>(light.exposure);
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
        if (!fisheye_ray(camera, x, y, ray)) continue;
        picture.at(x, y) = srgb_from_linear(Vec3(exposure * shade(turn * ray.cast<float>())));
      }
  });
}

}  // namespace mixrig::studio
