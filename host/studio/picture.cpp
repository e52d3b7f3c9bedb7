// SPDX-License-Identifier: Apache-2.0
// Pictures from surfels.
#include "host/studio/picture.h"

#include <algorithm>
#include <array>

namespace mixrig::studio {
namespace {

constexpr int kBand = 4;
const Vec3 kLuminance(0.2126F, 0.7152F, 0.0722F);

const Extent* extent_or_null(const Occluder& occluder, bool cull) {
  return cull ? &occluder.extent : nullptr;
}

/// The surfels of a pixel in one scene with the light that is left on them in this frame.
struct Layer {
  std::span<const Surfel> surfels;
  std::array<Lit, kSubSamples> lit;

  const Surfel* at(int i) const {
    if (surfels.empty()) return nullptr;
    return &surfels[surfels.size() == 1 ? 0 : static_cast<std::size_t>(i)];
  }
  const Lit& light_at(int i) const {
    return lit[surfels.size() == 1 ? 0 : static_cast<std::size_t>(i)];
  }
  float z(int i) const {
    const Surfel* s = at(i);
    return s == nullptr ? kMiss : s->z;
  }
};

void fill(Layer& layer, std::span<const Surfel> surfels, bool is_person, const LampSet& lamps,
          const Shadowers& shadowers) {
  layer.surfels = surfels;
  for (std::size_t i = 0; i < surfels.size(); ++i)
    layer.lit[i] = is_person ? Lit{surfels[i].real, surfels[i].mixed}
                             : past_person(surfels[i], lamps, shadowers);
}

Vec3 radiance(const Surfel& surfel, float lamp_light, const Vec3& tint, const Vec3& ambient) {
  if (surfel.glows) return surfel.albedo;
  return surfel.albedo.cwiseProduct(ambient + lamp_light * tint);
}

}  // namespace

void light_surfels(SurfelMap& map, const LampSet& lamps, const Shadowers& shadowers,
                   bool with_object, bool with_person, Crew& crew) {
  const Rect rect = map.rect();
  if (rect.empty()) return;
  crew.rows(rect.y1 - rect.y0, kBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (Surfel& s : map.row(rect.y0 + y)) {
        if (s.z == kMiss || s.glows) continue;
        LampMask open = lamps.facing(s.origin, s.normal);
        open = lamps.open(shadowers.furniture->scene,
                          extent_or_null(*shadowers.furniture, shadowers.cull), s.origin, open);
        if (with_person) open = lamps.open(shadowers.person->scene, nullptr, s.origin, open);
        s.open_real = s.open_mixed = open;
        s.real = s.mixed = lamps.irradiance(s.origin, s.normal, open);
        if (!with_object) continue;
        s.open_mixed =
            lamps.open(shadowers.object->scene, extent_or_null(*shadowers.object, shadowers.cull),
                       s.origin, open);
        if (s.open_mixed != open) s.mixed = lamps.irradiance(s.origin, s.normal, s.open_mixed);
      }
  });
}

Lit past_person(const Surfel& surfel, const LampSet& lamps, const Shadowers& shadowers) {
  const Occluder& person = *shadowers.person;
  if (surfel.z == kMiss || person.scene.empty()) return {surfel.real, surfel.mixed};
  const LampMask open = lamps.open(person.scene, extent_or_null(person, shadowers.cull),
                                   surfel.origin, surfel.open_real);
  if (open == surfel.open_real) return {surfel.real, surfel.mixed};
  const float real = lamps.irradiance(surfel.origin, surfel.normal, open);
  const LampMask both = open & surfel.open_mixed;
  return {real, both == open ? real : lamps.irradiance(surfel.origin, surfel.normal, both)};
}

Pixel compose_pixel(const Sight& sight, int x, int y, const LampSet& lamps, const Vec3& ambient,
                    const Shadowers& shadowers, bool with_object) {
  Layer room, person, object;
  fill(room, sight.room.at(x, y), false, lamps, shadowers);
  fill(person, sight.person.at(x, y), true, lamps, shadowers);
  if (with_object) fill(object, sight.object.at(x, y), false, lamps, shadowers);
  const bool flat =
      room.surfels.size() <= 1 && person.surfels.size() <= 1 && object.surfels.size() <= 1;
  const int count = flat ? 1 : kSubSamples;
  Pixel pixel;
  pixel.real = pixel.mixed = Vec3::Zero();
  Vec3 light_real = Vec3::Zero(), light_mixed = Vec3::Zero();
  std::array<int, 3> seen{};
  for (int i = 0; i < count; ++i) {
    const bool is_person = person.z(i) < room.z(i);
    const Layer& real = is_person ? person : room;
    const Surfel* surfel = real.at(i);
    if (surfel == nullptr || surfel->z == kMiss) continue;
    const Lit& lit = real.light_at(i);
    pixel.real += radiance(*surfel, lit.real, lamps.tint(), ambient);
    pixel.person += is_person ? 1.0F : 0.0F;
    if (!with_object) continue;
    light_real += ambient + lit.real * lamps.tint();
    light_mixed += ambient + lit.mixed * lamps.tint();
    const bool is_virtual = object.z(i) < surfel->z;
    pixel.silhouette += object.z(i) != kMiss ? 1.0F : 0.0F;
    pixel.mixed += is_virtual
                       ? radiance(*object.at(i), object.light_at(i).mixed, lamps.tint(), ambient)
                       : radiance(*surfel, lit.mixed, lamps.tint(), ambient);
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

}  // namespace mixrig::studio
