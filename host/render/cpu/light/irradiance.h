// SPDX-License-Identifier: Apache-2.0
// Light of all lamps on surfaces, past what casts shadows, a register of points at a time.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "host/render/cpu/light/gloss.h"
#include "host/render/cpu/light/lamp_set.h"
#include "host/render/cpu/light/visibility.h"

namespace mixrig::render::cpu {

/// Points of surfaces with unit normals, camera axes; finite.
struct SurfaceLanes {
  VectorLanes position_m, normal;
  FloatLanes roughness{};  ///< 0..1; only where the frame has glossy surfaces
  void set(int i, const glm::vec3& p, const glm::vec3& n) {
    position_m.x[i] = p.x, position_m.y[i] = p.y, position_m.z[i] = p.z;
    normal.x[i] = n.x, normal.y[i] = n.y, normal.z[i] = n.z;
  }
};

struct PeopleGrid;
/// Maps of people, and the whole lamps that they may hide: at most the first kMostLamps. Where the
/// grid knows a lamp its map is not looked at.
struct PeopleMaps {
  const std::vector<LampParams>& lamps;
  const std::vector<ShadowMap>& maps;
  const PeopleGrid& grid;
  LampSet maybe = kAllLamps;
};

/// Luminance of an unhidden lamp on the points.
FloatLanes lamp_light(const LampParams& lamp, const SurfaceLanes& at);

/// Light with the virtual objects over light without, luminance, 0..1. `maps`: of each lamp.
/// `near`: objects may hide ambient light.
FloatLanes light_ratio(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                       bool near, const SurfaceLanes& at);
/// The same where what people hide of a lamp is dark already. False where they hide nothing; then
/// `ratio` is not set.
bool light_ratio_past_people(const FrameParams& frame, const std::vector<ShadowMap>& maps,
                             LampSet maybe, bool near, const PeopleMaps& people,
                             const SurfaceLanes& at, FloatLanes& ratio);

/// Of real surfaces: what light_ratio() sums.
struct LightShares {
  std::array<FloatLanes, kMostLamps> part,
      lost;            ///< of a lamp in doubt: of all light, hidden of it
  FloatLanes ambient;  ///< what is lost of it, of all light; negative where more is sent
  /// Precondition: at most kMostLamps maps.
  void find(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe, bool near,
            const SurfaceLanes& at);
};
/// Share of a lamp that objects hide from real surfaces.
FloatLanes hidden_of(const LampParams& lamp, const ShadowMap& map, const SurfaceLanes& at);
/// Share of a lamp that is seen past the real room.
FloatLanes room_share(const FrameParams& frame, const LampParams& lamp, const SurfaceLanes& at);

/// Whether what the real room hides of a lamp is in the shares that shading() is given.
enum class PastRoom { kFind, kInShare };

/// Exposed light of all lamps and the ambient light. Without glossy surfaces in the frame only
/// `diffuse` is set. `maybe`: lamps that objects may hide; `share`: of the first lamps what is seen
/// of each past what else hides them. What each of the first whole lamps gives, luminance, not
/// exposed, is added to `lamp_light`.
ShadingLanes shading(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                     const SurfaceLanes& at, std::span<const FloatLanes> share = {},
                     PastRoom past_room = PastRoom::kFind, std::span<FloatLanes> lamp_light = {});

/// The same light past people too. False where people hide nothing; then `light` is not set.
bool shading_past_people(const FrameParams& frame, const std::vector<ShadowMap>& maps,
                         LampSet maybe, const PeopleMaps& people, const SurfaceLanes& at,
                         ShadingLanes& light);

/// Share of each whole lamp that is seen past people, as many as there are maps and room for. False
/// where they hide nothing; then all are 1.
bool seen_past_people(const PeopleMaps& people, const SurfaceLanes& at,
                      std::span<FloatLanes> share);

/// Of real surfaces, over all light without people: what objects take of the ambient light, and of
/// each whole lamp what reaches the surface without them and what of it they hide.
struct LampShares {
  FloatLanes ambient;
  std::array<FloatLanes, kMostLamps> light, hidden;
};
/// Of the first `count` whole lamps. Precondition: at most kMostLamps maps.
void find_lamp_shares(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                      bool near, const SurfaceLanes& at, std::size_t count, LampShares& out);

}  // namespace mixrig::render::cpu
