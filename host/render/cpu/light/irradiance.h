// SPDX-License-Identifier: Apache-2.0
// Light of all lamps on surfaces, with shadows, for a register of points at a time.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "host/render/cpu/light/gloss.h"
#include "host/render/cpu/light/lamp_set.h"
#include "host/render/cpu/light/visibility.h"

namespace mixrig::render::cpu {

/// Points of surfaces with unit normals, in camera axes; finite.
struct SurfaceLanes {
  VectorLanes position_m, normal;
  FloatLanes roughness{};  ///< 0..1; set only if the frame has glossy surfaces
  void set(int i, const glm::vec3& p, const glm::vec3& n) {
    position_m.x[i] = p.x, position_m.y[i] = p.y, position_m.z[i] = p.z;
    normal.x[i] = n.x, normal.y[i] = n.y, normal.z[i] = n.z;
  }
};

struct PeopleGrid;
/// Maps of people, and the whole lamps that people may hide: at most the first kMostLamps. For
/// lamps that `grid` holds, their map is not read.
struct PeopleMaps {
  const std::vector<LampParams>& lamps;
  const std::vector<ShadowMap>& maps;
  const PeopleGrid& grid;
  LampSet maybe = kAllLamps;
};

/// Luminance that a lamp, not hidden, gives to the points.
FloatLanes lamp_light(const LampParams& lamp, const SurfaceLanes& at);

/// Luminance with the virtual objects over luminance without them, 0..1. `maps`: one a lamp.
/// `near`: objects may hide ambient light.
FloatLanes light_ratio(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                       bool near, const SurfaceLanes& at);
/// light_ratio() where people's shadows are dark in the plate already. Returns false if people hide
/// nothing at the points; `ratio` is then not set.
bool light_ratio_past_people(const FrameParams& frame, const std::vector<ShadowMap>& maps,
                             LampSet maybe, bool near, const PeopleMaps& people,
                             const SurfaceLanes& at, FloatLanes& ratio);

/// The shares that light_ratio() sums, for real surfaces.
struct LightShares {
  std::array<FloatLanes, kMostLamps> part,
      lost;  ///< of a lamp in doubt: its share of all light; how much of that is hidden
  /// Share of all light that is lost of the ambient light; negative where more is sent.
  FloatLanes ambient;
  /// Precondition: at most kMostLamps maps.
  void find(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe, bool near,
            const SurfaceLanes& at);
};
/// Share of a lamp that objects hide from real surfaces.
FloatLanes hidden_of(const LampParams& lamp, const ShadowMap& map, const SurfaceLanes& at);
/// Share of a lamp that is visible past the real room.
FloatLanes room_share(const FrameParams& frame, const LampParams& lamp, const SurfaceLanes& at);

/// Whether the shares that shading() is given already include what the real room hides of a lamp.
enum class PastRoom { kFind, kInShare };

/// Exposed light of all lamps and the ambient light. Without glossy surfaces in the frame only
/// `diffuse` is set. `maybe`: lamps that objects may hide. `share`: of the first lamps, what is
/// visible past anything else that hides them. The luminance, not exposed, of each of the first
/// whole lamps is added to `lamp_light`.
ShadingLanes shading(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                     const SurfaceLanes& at, std::span<const FloatLanes> share = {},
                     PastRoom past_room = PastRoom::kFind, std::span<FloatLanes> lamp_light = {});

/// shading() with people's shadows too. Returns false if people hide nothing; `light` is then not
/// set.
bool shading_past_people(const FrameParams& frame, const std::vector<ShadowMap>& maps,
                         LampSet maybe, const PeopleMaps& people, const SurfaceLanes& at,
                         ShadingLanes& light);

/// Share of each whole lamp that is visible past people, for as many as there are maps and entries
/// in `share`. Returns false if they hide nothing; all shares are then 1.
bool seen_past_people(const PeopleMaps& people, const SurfaceLanes& at,
                      std::span<FloatLanes> share);

/// Shares for real surfaces, relative to all light without people: ambient light that objects take,
/// and of each whole lamp its light without objects and the part that objects hide.
struct LampShares {
  FloatLanes ambient;
  std::array<FloatLanes, kMostLamps> light, hidden;
};
/// Finds the shares of the first `count` whole lamps. Precondition: at most kMostLamps maps.
void find_lamp_shares(const FrameParams& frame, const std::vector<ShadowMap>& maps, LampSet maybe,
                      bool near, const SurfaceLanes& at, std::size_t count, LampShares& out);

}  // namespace mixrig::render::cpu
