// SPDX-License-Identifier: Apache-2.0
// Pictures from surfels.
#include "studio/sensors/picture.h"

#include <algorithm>
#include <array>
#include <bitset>

namespace mixrig::studio {
namespace {

constexpr int kPictureBand = 4;
const Vec3 kLuminance(0.2126F, 0.7152F, 0.0722F);

const Extent* extent_or_null(const Occluder& occluder, bool cull) {
  return cull ? &occluder.extent : nullptr;
}

/// The surfels of a pixel in one scene, with their lamp light in this frame, which is found when it
/// is first asked for: what is hidden casts no rays.
class Layer {
 public:
  Layer(std::span<const Surfel> surfels, bool is_person, const LampSet& lamps,
        const ShadowCasters& casters)
      : surfels_(surfels), is_person_(is_person), lamps_(lamps), casters_(casters) {}

  std::size_t size() const { return surfels_.size(); }
  const Surfel* at(int i) const { return surfels_.empty() ? nullptr : &surfels_[index_of(i)]; }
  float z(int i) const {
    const Surfel* s = at(i);
    return s == nullptr ? kMiss : s->z;
  }
  const LampLight& light_at(int i) {
    const std::size_t index = index_of(i);
    if (!known_[index]) light(surfels_[index], lit_[index]);
    known_.set(index);
    return lit_[index];
  }

 private:
  std::size_t index_of(int i) const {
    return surfels_.size() == 1 ? 0 : static_cast<std::size_t>(i);
  }
  void light(const Surfel& s, LampLight& lit) const {
    lit = is_person_ ? LampLight{s.real, s.mixed} : with_person_shadow(s, lamps_, casters_);
    lit.gloss_real = s.gloss_real, lit.gloss_mixed = s.gloss_mixed;
    if (casters_.reflector != nullptr && s.reflectance > 0)
      add_person(*casters_.reflector, s, lit.gloss_real, lit.gloss_mixed);
  }

  std::span<const Surfel> surfels_;
  bool is_person_;
  const LampSet& lamps_;
  const ShadowCasters& casters_;
  std::array<LampLight, kSubSamples> lit_;
  std::bitset<kSubSamples> known_;
};

struct SurfelLight {
  float lamps;
  const Vec3& bounce;
  const Vec3& gloss;
};

Vec3 radiance(const Surfel& surfel, const SurfelLight& light, const Vec3& tint,
              const Vec3& ambient) {
  if (surfel.glows) return surfel.albedo;
  return surfel.albedo.cwiseProduct(ambient + light.lamps * tint + light.bounce) + light.gloss;
}

Vec3 real_radiance(const Surfel& s, const LampLight& lit, const Vec3& tint, const Vec3& ambient) {
  return radiance(s, {lit.real, s.bounce_real, lit.gloss_real}, tint, ambient);
}
Vec3 mixed_radiance(const Surfel& s, const LampLight& lit, const Vec3& tint, const Vec3& ambient) {
  return radiance(s, {lit.mixed, s.bounce_mixed, lit.gloss_mixed}, tint, ambient);
}

}  // namespace

void light_surfels(SurfelMap& map, const LampSet& lamps, const ShadowCasters& casters,
                   bool with_object, bool with_person, Crew& crew) {
  const Rect rect = map.rect();
  if (rect.empty()) return;
  crew.rows(rect.y1 - rect.y0, kPictureBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (Surfel& s : map.row(rect.y0 + y)) {
        if (s.z == kMiss || s.glows) continue;
        LampMask open = lamps.facing(s.origin, s.normal);
        open = lamps.open(casters.furniture->scene,
                          extent_or_null(*casters.furniture, casters.cull), s.origin, open);
        if (with_person) open = lamps.open(casters.person->scene, nullptr, s.origin, open);
        s.open_real = s.open_mixed = open;
        s.real = s.mixed = lamps.irradiance(s.origin, s.normal, open);
        if (!with_object) continue;
        s.open_mixed = lamps.open(casters.object->scene,
                                  extent_or_null(*casters.object, casters.cull), s.origin, open);
        if (s.open_mixed != open) s.mixed = lamps.irradiance(s.origin, s.normal, s.open_mixed);
      }
  });
}

LampLight with_person_shadow(const Surfel& surfel, const LampSet& lamps,
                             const ShadowCasters& casters) {
  const Occluder& person = *casters.person;
  if (surfel.z == kMiss || person.scene.empty()) return {surfel.real, surfel.mixed};
  const LampMask open = lamps.open(person.scene, extent_or_null(person, casters.cull),
                                   surfel.origin, surfel.open_real);
  if (open == surfel.open_real) return {surfel.real, surfel.mixed};
  const float real = lamps.irradiance(surfel.origin, surfel.normal, open);
  const LampMask both = open & surfel.open_mixed;
  return {real, both == open ? real : lamps.irradiance(surfel.origin, surfel.normal, both)};
}

Pixel compose_pixel(const SceneSurfels& surfels, int x, int y, const LampSet& lamps,
                    const Vec3& ambient, const ShadowCasters& casters, bool with_object) {
  Layer room(surfels.room.at(x, y), false, lamps, casters);
  Layer person(surfels.person.at(x, y), true, lamps, casters);
  Layer object(with_object ? surfels.object.at(x, y) : std::span<const Surfel>(), false, lamps,
               casters);
  const bool flat = room.size() <= 1 && person.size() <= 1 && object.size() <= 1;
  const int count = flat ? 1 : kSubSamples;
  Pixel pixel;
  pixel.real = pixel.mixed = Vec3::Zero();
  Vec3 light_real = Vec3::Zero(), light_mixed = Vec3::Zero();
  std::array<int, 3> seen{};
  for (int i = 0; i < count; ++i) {
    const bool is_person = person.z(i) < room.z(i);
    Layer& real = is_person ? person : room;
    const Surfel* surfel = real.at(i);
    if (surfel == nullptr || surfel->z == kMiss) continue;
    const LampLight& lit = real.light_at(i);
    pixel.real += real_radiance(*surfel, lit, lamps.tint(), ambient);
    pixel.person += is_person ? 1.0F : 0.0F;
    if (!with_object) continue;
    light_real += ambient + lit.real * lamps.tint() + surfel->bounce_real;
    light_mixed += ambient + lit.mixed * lamps.tint() + surfel->bounce_mixed;
    const bool is_virtual = object.z(i) < surfel->z;
    pixel.silhouette += object.z(i) != kMiss ? 1.0F : 0.0F;
    pixel.mixed += is_virtual
                       ? mixed_radiance(*object.at(i), object.light_at(i), lamps.tint(), ambient)
                       : mixed_radiance(*surfel, lit, lamps.tint(), ambient);
    ++seen[is_virtual ? Truth::kVirtual : is_person ? Truth::kPerson : Truth::kBackground];
  }
  const float share = 1.0F / static_cast<float>(count);
  pixel.real *= share, pixel.mixed *= share, pixel.person *= share, pixel.silhouette *= share;
  if (!with_object) return pixel;
  if (light_real.sum() > 0) pixel.light = light_mixed.dot(kLuminance) / light_real.dot(kLuminance);
  pixel.layer =
      static_cast<std::uint8_t>(std::max_element(seen.begin(), seen.end()) - seen.begin());
  return pixel;
}

Vec3 with_person(const SceneSurfels& surfels, int x, int y, const LampSet& lamps,
                 const Vec3& ambient, const ShadowCasters& casters, const Vec3& behind) {
  Layer person(surfels.person.at(x, y), true, lamps, casters);
  if (person.size() == 0) return behind;
  Layer room(surfels.room.at(x, y), false, lamps, casters);
  const int count = room.size() <= 1 && person.size() <= 1 ? 1 : kSubSamples;
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < count; ++i) {
    if (person.z(i) < room.z(i))
      sum += real_radiance(*person.at(i), person.light_at(i), lamps.tint(), ambient);
    else if (room.size() <= 1)
      sum += behind;
    else if (room.at(i)->z < kMiss)
      sum += real_radiance(*room.at(i), room.light_at(i), lamps.tint(), ambient);
  }
  return sum / static_cast<float>(count);
}

}  // namespace mixrig::studio
