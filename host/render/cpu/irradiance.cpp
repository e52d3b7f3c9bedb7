// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "host/render/cpu/contact.h"

namespace mixrig::render::cpu {
namespace {

constexpr float kFaintestLight = 1e-12F;

/// Irradiance by an unhidden lamp of intensity 1, as CONVENTIONS.md has it.
FloatLanes irradiance(const LampParams& lamp, const SurfaceLanes& at) {
  const FloatLanes x = lamp.position_m.x - at.position_m.x, y = lamp.position_m.y - at.position_m.y,
                   z = lamp.position_m.z - at.position_m.z;
  const FloatLanes distance2 = max(x * x + y * y + z * z, FloatLanes{} + kLeastDistance2);
  const FloatLanes receiver =
      max(at.normal.x * x + at.normal.y * y + at.normal.z * z, FloatLanes{});
  // Both cosines lack a division by the distance.
  const glm::vec3 d = lamp.direction;
  const FloatLanes emitter =
      d == glm::vec3(0) ? sqrt(distance2) : max(-(x * d.x + y * d.y + z * d.z), FloatLanes{});
  return receiver * emitter / (distance2 * distance2);
}

/// Cell below a place along an axis of `count` cells, and the way on to the next one.
struct CellLanes {
  IntLanes first;
  FloatLanes share;
};
CellLanes cell_at(FloatLanes at, int count) {
  const FloatLanes inside =
      min(max(at, FloatLanes{}), FloatLanes{} + static_cast<float>(count - 1));
  const IntLanes whole = truncate(inside), last = IntLanes{} + std::max(count - 2, 0);
  const IntLanes first = whole > last ? last : whole;
  return {first, inside - to_float(first)};
}

/// Share of a lamp that is seen past the real room: RoomShade, trilinear.
FloatLanes share_in_room(const FrameParams& frame, const LampParams& lamp, const SurfaceLanes& at) {
  if (lamp.room_layer < 0) return FloatLanes{} + 1.0F;
  const RoomShadeParams& room = frame.room;
  const FloatLanes px = at.position_m.x + room.lift_m * at.normal.x,
                   py = at.position_m.y + room.lift_m * at.normal.y,
                   pz = at.position_m.z + room.lift_m * at.normal.z;
  const auto cell = [&](int axis) {
    const glm::mat4& m = room.cell_from_camera;
    return cell_at(px * m[0][axis] + py * m[1][axis] + pz * m[2][axis] + m[3][axis],
                   room.cells[axis]);
  };
  const CellLanes x = cell(0), y = cell(1), z = cell(2);
  const int columns = room.cells.x, plane = columns * room.cells.y;
  const float* const shares =
      frame.room_share.data() + static_cast<std::ptrdiff_t>(lamp.room_layer) * plane * room.cells.z;
  const IntLanes first = x.first + y.first * columns + z.first * plane;
  const auto along_x = [&](int offset) {
    const FloatLanes a = gather(shares, first + offset), b = gather(shares, first + (offset + 1));
    return a + (b - a) * x.share;
  };
  const auto along_y = [&](int offset) {
    const FloatLanes a = along_x(offset), b = along_x(offset + columns);
    return a + (b - a) * y.share;
  };
  const FloatLanes a = along_y(0), b = along_y(plane);
  return a + (b - a) * z.share;
}

/// The same for one lamp after another: parts of a panel, which follow each other, share it.
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

/// Of real surfaces, which are in no map of objects.
VectorLanes no_normal() { return {FloatLanes{}, FloatLanes{}, FloatLanes{}}; }

/// What is seen of the whole lamps past people.
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

/// Luminance of a lamp of the real scene without the virtual objects.
FloatLanes real_light(const LampParams& lamp, const PastPeople* past, const SurfaceLanes& at,
                      RoomShares& room) {
  FloatLanes light = lamp_light(lamp, at);
  if (!any(light > 0)) return light;
  light *= room.of(lamp);
  return past != nullptr ? light * past->of(lamp) : light;
}

/// What the objects take of the ambient light of the real scene, luminance.
FloatLanes lost_ambient(const FrameParams& frame, const SurfaceLanes& at) {
  const ContactLanes contact = contact_at(frame, at.position_m, at.normal, Receiver::kReal);
  return luminance(frame.light.ambient) * (1 - contact.open) -
         (kRec709Red * contact.sent.x + kRec709Green * contact.sent.y +
          kRec709Blue * contact.sent.z);
}

/// As light_ratio(); null: nobody hides a lamp.
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

/// Ambient light past the objects, on these.
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
      of_lamp *= visibility(lamp, maps[k], at.position_m, at.normal, of_lamp > 0);
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
  for (std::size_t k = 0; k < std::min(people.maps.size(), share.size()); ++k) {
    share[k] = FloatLanes{} + 1.0F;
    if (!holds(people.maybe, k)) continue;
    share[k] = visibility(people.lamps[k], people.maps[k], at.position_m, at.normal);
    hides |= any(share[k] < 1);
  }
  return hides;
}

LostLight lost_light(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                     bool near, const SurfaceLanes& at, std::span<const FloatLanes> share) {
  RoomShares room(frame, at);
  LostLight lost{};
  FloatLanes of_lamps{};
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const LampParams& lamp = frame.lamps[k];
    const FloatLanes light = real_light(lamp, nullptr, at, room);
    if (!any(light > 0)) continue;
    const auto whole = static_cast<std::size_t>(lamp.part_of);
    const FloatLanes past = whole < share.size() ? share[whole] : FloatLanes{} + 1.0F;
    of_lamps += light;
    lost.by_people += light * (1 - past);
    if (!holds(maybe, k)) continue;
    const FloatLanes hidden =
        light * (1 - visibility(lamp, maps[k], at.position_m, no_normal(), light > 0));
    lost.lamps += hidden;
    lost.past_people += hidden * past;
  }
  const FloatLanes least = FloatLanes{} + kFaintestLight;
  const FloatLanes over = 1 / max(of_lamps + luminance(frame.light.ambient), least);
  lost.seen = 1 - lost.by_people / max(of_lamps, least);
  lost.ambient = near ? lost_ambient(frame, at) * over : FloatLanes{};
  lost.lamps *= over, lost.past_people *= over, lost.by_people *= over;
  return lost;
}

}  // namespace mixrig::render::cpu
