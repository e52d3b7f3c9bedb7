// SPDX-License-Identifier: Apache-2.0
// The fisheye picture.
#include "studio/sensors/fisheye.h"

#include <atomic>
#include <cmath>

#include "studio/srgb.h"

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
                       const LampSet& lamps, const Light& light, Crew& crew, Image<Rgbf>& sum,
                       double& people_share) {
  const Vec3 eye = world_from_fisheye.translation_m.cast<float>();
  const Eigen::Matrix3f turn = world_from_fisheye.rotation.toRotationMatrix().cast<float>();
  const float exposure = sample.share * kExposure * static_cast<float>(light.exposure);
  constexpr float kMirrored = 0.85F;
  const auto meets = [&](const Vec3& from, const Vec3& ray, Hit& hit, bool& on_person) {
    Hit person;
    const bool on_room = room.intersect(from, ray, kMiss, hit);
    on_person = casters.person->scene.intersect(from, ray, on_room ? hit.t : kMiss, person);
    if (on_person) hit = person;
    return on_room || on_person;
  };
  const auto lit = [&](const Hit& hit, const Vec3& position) -> Vec3 {
    const Vec3 albedo = materials.albedo(hit.material, hit.uv, position);
    if (hit.material.kind == Kind::kLamp) return albedo;
    const Vec3 origin = position + kShadowOffset_m * hit.face;
    LampMask open = lamps.facing(origin, hit.normal);
    for (const Occluder* occluder : {casters.furniture, casters.person})
      open = lamps.open(occluder->scene, &occluder->extent, origin, open);
    return albedo.cwiseProduct(light.ambient +
                               lamps.irradiance(origin, hit.normal, open) * lamps.tint());
  };
  const auto shade = [&](const Vec3& ray, bool& on_person) -> Vec3 {
    Hit hit, image;
    if (!meets(eye, ray, hit, on_person)) return Vec3::Zero();
    const Vec3 position = eye + hit.t * ray;
    const Vec3 light_here = lit(hit, position);
    if (hit.material.kind != Kind::kMirror) return light_here;
    const Vec3 back = ray - 2 * ray.dot(hit.normal) * hit.normal;
    const Vec3 from = position + kShadowOffset_m * hit.face;
    bool person = false;
    if (!meets(from, back, image, person)) return light_here;
    return light_here + kMirrored * lit(image, from + image.t * back);
  };
  std::atomic<long> seen = 0, on_people = 0;
  crew.rows(camera.size_px.height, kFisheyeBand, [&](int begin, int end) {
    long rays = 0, people = 0;
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < camera.size_px.width; ++x) {
        Eigen::Vector3d ray;
        if (!fisheye_ray(camera, x + sample.x_px, y + sample.y_px, ray)) continue;
        bool on_person = false;
        const Vec3 c = exposure * shade(turn * ray.cast<float>(), on_person);
        Rgbf& out = sum.at(x, y);
        out = {out.r + c.x(), out.g + c.y(), out.b + c.z()};
        ++rays, people += on_person ? 1 : 0;
      }
    seen += rays, on_people += people;
  });
  people_share += sample.share * static_cast<double>(on_people) / static_cast<double>(seen);
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
