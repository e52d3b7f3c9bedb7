// SPDX-License-Identifier: Apache-2.0
// Pass light: how much light real surfaces keep beside the virtual objects, and the shading of the
// objects.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/background/background.h"
#include "host/render/cpu/light/people_shadow.h"
#include "host/render/cpu/light/shadow.h"
#include "host/render/cpu/virtual/virtual.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// What is known of a background tile until the pose changes; used if people cast shadows.
struct BackgroundTile {
  bool seen = false;       ///< the next three members are set
  bool in_shadow = false;  ///< an object shades some of it
  float near_m = 0, far_m = 0;
  bool has_corners = false;  ///< `flat` and the tile's row of LightLayer::corners are set
  std::uint32_t flat = 0;    ///< one bit a cell
};

/// Light maps, 65535 = 1, and working memory of the pass.
struct LightLayer {
  LightLayer() = default;
  explicit LightLayer(Size view_size);
  Image<std::uint16_t> background;  ///< of the empty room; kept while the pose stays
  Image<std::uint16_t> visible;     ///< of the surfaces that the plate shows
  Image<float> tile_w, tile_light;  ///< of people, one value a tile; w 0: no people
  std::vector<BackgroundTile> room_tiles;
  RoomFor<float> corners;  ///< one row a tile: CornerLights
};

/// Inputs of the pass.
struct LightInput {
  const FrameParams& frame;
  const Tables& tables;
  const BackgroundView& background;
  const std::vector<ShadowMap>& maps;
  /// Draws the normals of `background`; null: those of the tables.
  const MovingBackground* moving = nullptr;
  const PeopleShadow* people = nullptr;
};

/// Whether any object affects the light of others; if not, the light map is 1 everywhere.
bool has_shadows(const FrameParams& frame);

/// Computes the light of the background; call it after a change of pose.
void light_background(Crew& crew, const LightInput& input, LightLayer& light);
/// Turns the layer's albedo into shaded colour; call it after draw_virtual().
void shade_virtual(Crew& crew, const LightInput& input, VirtualLayer& layer);
/// Shades again where people of this or the last frame hide a lamp; returns false if they do
/// nowhere. Call it after shade_virtual().
bool shade_behind_people(Crew& crew, const LightInput& input, VirtualLayer& layer);
/// Allocates what shade_behind_people() and light_visible_background() need.
void size_for_people(const FrameParams& frame, Size view_size, VirtualLayer& layer);
void size_for_people(const FrameParams& frame, Size view_size, LightLayer& light);
/// Computes the light of the background in this frame: where people hide a lamp from an object's
/// shadow, the plate is dark already. Call it after light_background().
void light_visible_background(Crew& crew, const LightInput& input, LightLayer& light);
/// Computes the light of the visible surfaces, mixing people's and the background's by `matte`.
/// People's light, where the matte is at least half, is computed once a tile at depth `view_w` (no
/// ToF camera resolves finer) and interpolated. Call it after light_visible_background().
void light_people(Crew& crew, const LightInput& input, const Image<float>& view_w,
                  const Image<std::uint8_t>& matte, LightLayer& light);

}  // namespace mixrig::render::cpu
