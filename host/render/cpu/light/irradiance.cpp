// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/light/irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/render/cpu/light/contact.h"
#include "host/render/cpu/light/people_grid.h"

namespace mixrig::render::cpu {
namespace {

constexpr float kFaintestLight = 1e-12F;

/// Irradiance by a lamp of intensity 1 that nothing hides, as CONVENTIONS.md defines it.
FloatLanes irradiance(const LampParams& lamp, const SurfaceLanes& at) {
  const FloatLanes x = lamp.position_m.x - at.position_m.x, y = lamp.position_m.y - at.position_m.y,
                   z = lamp.position_m.z - at.position_m.z;
  const FloatLanes distance2 = max(x * x + y * y + z * z, FloatLanes{} + kLeastDistance2);
  const FloatLanes receiver =
      max(at.normal.x * x + at.normal.y * y + at.normal.z * z, FloatLanes{});
  // Both cosines still lack a division by the distance.
  const glm::vec3 d = lamp.direction;
  const FloatLanes emitter =
      d == glm::vec3(0) ? sqrt(distance2) : max(-(x * d.x + y * d.y + z * d.z), FloatLanes{});
  return receiver * emitter / (distance2 * distance2);
}

/// Share of a lamp that is visible past the real room, by RoomShade, trilinear.
FloatLanes share_in_room(const FrameParams& frame, const LampParams& lamp, const SurfaceLanes& at) {
  if (lamp.room_layer < 0) return FloatLanes{} + 1.0F;
  const RoomShadeParams& room = frame.room;
  const FloatLanes px = at.position_m.x + room.lift_m * at.normal.x,
                   py = at.position_m.y + room.lift_m * at.normal.y,
                   pz = at.position_m.z + room.lift_m * at.normal.z;
  const GridLanes places(room, {px, py, pz});
  const int layer = room.cells.x * room.cells.y * room.cells.z;
  return places.read(frame.room_share.data() +
                     static_cast<std::ptrdiff_t>(lamp.room_layer) * layer);
}

/// Caches share_in_room() for one lamp after another: parts of a panel follow each other and share
/// it.
class RoomShares {
 public:
  RoomShares(const FrameParams& frame, const SurfaceLanes& at) : frame_(frame), at_(at) {}
  const FloatLanes& of(const LampParams& lamp) {
    if (lamp.room_layer != layer_)
      share_ = share_in_room(frame_, lamp, at_), layer_ = lamp.room_layer;
    return share_;
  }

 private:
  const FrameParams& frame_;
  const SurfaceLanes& at_;
  int layer_ = -1;
  FloatLanes share_ = FloatLanes{} + 1.0F;
};

/// Normal 0, for real surfaces: they are in no map of objects.
VectorLanes no_normal() { return {FloatLanes{}, FloatLanes{}, FloatLanes{}}; }

/// Shares of the whole lamps that are visible past people.
class PastPeople {
 public:
  PastPeople(const PeopleMaps& people, const SurfaceLanes& at)
      : count_(std::min(people.maps.size(), share_.size())),
        hides_(seen_past_people(people, at, share_)) {}
  bool hides() const { return hides_; }
  FloatLanes of(const LampParams& lamp) const {
    const auto whole = static_cast<std::size_t>(lamp.part_of);
    return whole < count_ ? share_[whole] : FloatLanes{} + 1.0F;
  }

 private:
  std::size_t count_;
  std::array<FloatLanes, kMostLamps> share_;
  bool hides_;
};

/// Luminance of a lamp on the real scene, without the virtual objects.
FloatLanes real_light(const LampParams& lamp, const PastPeople* past, const SurfaceLanes& at,
                      RoomShares& room) {
  FloatLanes light = lamp_light(lamp, at);
  if (!any(light > 0)) return light;
  light *= room.of(lamp);
  return past != nullptr ? light * past->of(lamp) : light;
}

/// Luminance that the objects take of the real scene's ambient light.
FloatLanes lost_ambient(const FrameParams& frame, const SurfaceLanes& at) {
  const ContactLanes contact = contact_at(frame, at.position_m, at.normal, Receiver::kReal);
  return luminance(frame.light.ambient) * (1 - contact.open) -
         (kRec709Red * contact.sent.x + kRec709Green * contact.sent.y +
          kRec709Blue * contact.sent.z);
}

/// light_ratio() past people; null: people hide no lamp.
FloatLanes ratio_past(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                      bool near, const SurfaceLanes& at, const PastPeople* people) {
  const FloatLanes one = FloatLanes{} + 1.0F;
  RoomShares room(frame, at);
  FloatLanes lost = near ? lost_ambient(frame, at) : FloatLanes{};
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    if (!holds(maybe, k)) continue;
    const IntLanes lit = irradiance(lamp, at) > 0;
    if (!any(lit)) continue;
    const FloatLanes hidden = 1 - visibility(lamp, maps[k], at.position_m, no_normal(), lit);
    if (!any(hidden > 0)) continue;
    lost += hidden * real_light(lamp, people, at, room);
  }
  if (!any(lost > 0)) return one;
  FloatLanes all = FloatLanes{} + luminance(frame.light.ambient);
  for (const LampParams& lamp : frame.lamps) all += real_light(lamp, people, at, room);
  return lost > 0 ? max(1 - lost / all, FloatLanes{}) : one;
}

}  // namespace

FloatLanes lamp_light(const LampParams& lamp, const SurfaceLanes& at) {
  return irradiance(lamp, at) * luminance(lamp.intensity);
}

FloatLanes light_ratio(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                       bool near, const SurfaceLanes& at) {
  return ratio_past(frame, maps, maybe, near, at, nullptr);
}

bool light_ratio_past_people(const FrameParams& frame, const std::vector<ShadowMap>& maps,
                             LampSet maybe, bool near, const PeopleMaps& people,
                             const SurfaceLanes& at, FloatLanes& ratio) {
  const PastPeople past(people, at);
  if (!past.hides()) return false;
  ratio = ratio_past(frame, maps, maybe, near, at, &past);
  return true;
}

void LightShares::find(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                       bool near, const SurfaceLanes& at) {
  RoomShares room(frame, at);
  FloatLanes all = FloatLanes{} + luminance(frame.light.ambient);
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    const FloatLanes light = real_light(lamp, nullptr, at, room);
    all += light;
    if (!holds(maybe, k)) continue;
    part[k] = light;
    lost[k] = any(light > 0) ? 1 - visibility(lamp, maps[k], at.position_m, no_normal(), light > 0)
                             : FloatLanes{};
  }
  const FloatLanes over = 1 / max(all, FloatLanes{} + kFaintestLight);
  for (std::size_t k = 0; k < maps.size(); ++k)
    if (holds(maybe, k)) part[k] *= over, lost[k] *= part[k];
  ambient = near ? lost_ambient(frame, at) * over : FloatLanes{};
}

FloatLanes hidden_of(const LampParams& lamp, const ShadowMap& map, const SurfaceLanes& at) {
  return 1 - visibility(lamp, map, at.position_m, no_normal());
}

FloatLanes room_share(const FrameParams& frame, const LampParams& lamp, const SurfaceLanes& at) {
  return share_in_room(frame, lamp, at);
}

namespace {

/// Adds the ambient light on surfaces of objects, past the objects.
void add_ambient_past_objects(const FrameParams& frame, const SurfaceLanes& at,
                              const std::optional<GlossLanes>& gloss, ShadingLanes& sum) {
  add_ambient(frame.light, at.normal, sum);
  if (gloss) add_ambient_gloss(frame.light, *gloss, sum);
  if (frame.contacts.empty()) return;
  const ContactLanes contact = contact_at(frame, at.position_m, at.normal, Receiver::kObject);
  for (VectorLanes* part : {&sum.diffuse, &sum.straight, &sum.grazing, &sum.lost})
    part->x *= contact.open, part->y *= contact.open, part->z *= contact.open;
  const float exposure = frame.light.exposure;
  sum.diffuse.x += exposure * contact.sent.x, sum.diffuse.y += exposure * contact.sent.y,
      sum.diffuse.z += exposure * contact.sent.z;
}

}  // namespace

ShadingLanes shading(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                     const SurfaceLanes& at, std::span<const FloatLanes> share, PastRoom past_room,
                     std::span<FloatLanes> lamp_light) {
  ShadingLanes sum;
  RoomShares room(frame, at);
  std::optional<GlossLanes> gloss;
  if (frame.glossy) gloss.emplace(at.position_m, at.normal, at.roughness);
  add_ambient_past_objects(frame, at, gloss, sum);
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    FloatLanes of_lamp = irradiance(lamp, at);
    if (k < share.size()) of_lamp *= share[k];
    if (!any(of_lamp > 0)) continue;
    if (holds(maybe, k))
      of_lamp *= visibility_of_caster(lamp, maps[k], at.position_m, at.normal, of_lamp > 0);
    const bool in_share = past_room == PastRoom::kInShare && k < share.size();
    if (lamp.room_layer >= 0 && !in_share) of_lamp *= room.of(lamp);
    const glm::vec3 intensity = frame.light.exposure * lamp.intensity;
    add(of_lamp, intensity, sum.diffuse);
    const auto whole = static_cast<std::size_t>(lamp.part_of);
    if (whole < lamp_light.size()) lamp_light[whole] += of_lamp * luminance(lamp.intensity);
    if (gloss) add_gloss(lamp, at.position_m, *gloss, of_lamp, intensity, sum);
  }
  return sum;
}

bool shading_past_people(const FrameParams& frame, const std::vector<ShadowMap>& maps,
                         LampSet maybe, const PeopleMaps& people, const SurfaceLanes& at,
                         ShadingLanes& light) {
  const PastPeople past(people, at);
  if (!past.hides()) return false;
  std::array<FloatLanes, kMostLamps> share;
  const std::size_t count = std::min(maps.size(), share.size());
  for (std::size_t k = 0; k < count; ++k) share[k] = past.of(frame.lamps[k]);
  light = shading(frame, maps, maybe, at, std::span(share).first(count));
  return true;
}

bool seen_past_people(const PeopleMaps& people, const SurfaceLanes& at,
                      std::span<FloatLanes> share) {
  bool hides = false;
  std::optional<GridLanes> places;
  if ((people.grid.lamps & people.maybe) != 0) places.emplace(people.grid.at, at.position_m);
  for (std::size_t k = 0; k < std::min(people.maps.size(), share.size()); ++k) {
    share[k] = FloatLanes{} + 1.0F;
    if (!holds(people.maybe, k)) continue;
    const bool known = places && holds(people.grid.lamps, k);
    const IntLanes by_map = known ? ~places->inside() : IntLanes{} - 1;
    if (any(by_map))
      share[k] = visibility(people.lamps[k], people.maps[k], at.position_m, at.normal, by_map);
    if (known) share[k] = by_map ? share[k] : places->read(people.grid.of(k));
    hides |= any(share[k] < 1);
  }
  return hides;
}

void find_lamp_shares(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                      bool near, const SurfaceLanes& at, std::size_t count, LampShares& out) {
  RoomShares room(frame, at);
  FloatLanes all = FloatLanes{} + luminance(frame.light.ambient);
  std::fill_n(out.light.begin(), count, FloatLanes{});
  std::fill_n(out.hidden.begin(), count, FloatLanes{});
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    const FloatLanes light = real_light(lamp, nullptr, at, room);
    const auto whole = static_cast<std::size_t>(lamp.part_of);
    if (!any(light > 0)) continue;
    all += light;
    if (whole >= count) continue;
    out.light[whole] += light;
    if (holds(maybe, k))
      out.hidden[whole] +=
          light * (1 - visibility(lamp, maps[k], at.position_m, no_normal(), light > 0));
  }
  const FloatLanes over = 1 / max(all, FloatLanes{} + kFaintestLight);
  for (std::size_t k = 0; k < count; ++k) out.light[k] *= over, out.hidden[k] *= over;
  out.ambient = near ? lost_ambient(frame, at) * over : FloatLanes{};
}

}  // namespace mixrig::render::cpu
