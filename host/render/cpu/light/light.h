// SPDX-License-Identifier: Apache-2.0
// Pass light: how much light real surfaces keep next to the virtual objects, and the shading of
// these.
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

/// What is known of a tile of the background until the pose changes; where people cast shadows.
struct BackgroundTile {
  bool seen = false;       ///< the next three are set
  bool in_shadow = false;  ///< of an object, somewhere
  float near_m = 0, far_m = 0;
  bool has_corners = false;  ///< the next one is, and its row of LightLayer::corners
  std::uint32_t flat = 0;    ///< a bit a cell
};

/// Light maps, 65535 = 1, and memory of the pass.
struct LightLayer {
  LightLayer() = default;
  explicit LightLayer(Size view_size);
  Image<std::uint16_t> background;  ///< of the empty room: stays while the pose stays
  Image<std::uint16_t> visible;     ///< of what the plate shows
  Image<float> tile_w, tile_light;  ///< of people's tiles; w 0: no people
  std::vector<BackgroundTile> room_tiles;
  RoomFor<float> corners;  ///< of each tile: CornerLights
};

/// Inputs of the pass.
struct LightInput {
  const FrameParams& frame;
  const Tables& tables;
  const BackgroundView& background;
  const std::vector<ShadowMap>& maps;
  const MovingBackground* moving =
      nullptr;  ///< gives the normals of `background`; null: the tables
  const PeopleShadow* people = nullptr;
};

/// Whether any object takes light from others; without, the light map is 1 everywhere.
bool has_shadows(const FrameParams& frame);

/// Light of the background. After a change of pose.
void light_background(Crew& crew, const LightInput& input, LightLayer& light);
/// Turns the layer's albedo into shaded colour. After draw_virtual.
void shade_virtual(Crew& crew, const LightInput& input, VirtualLayer& layer);
/// Shades again where people of this frame or of the last one hide a lamp; false: nowhere. After
/// shade_virtual.
bool shade_behind_people(Crew& crew, const LightInput& input, VirtualLayer& layer);
/// Makes the layers keep what shade_behind_people and light_visible_background need.
void size_for_people(const FrameParams& frame, Size view_size, VirtualLayer& layer);
void size_for_people(const FrameParams& frame, Size view_size, LightLayer& light);
/// Light of the background in this frame: where `people` hide a lamp from an object's shadow the
/// plate is dark already. After light_background.
void light_visible_background(Crew& crew, const LightInput& input, LightLayer& light);
/// Light of the visible surfaces, people's mixed with the background's by `matte`. That of people,
/// where it is at least half, with depth `view_w`, is found once in a tile (no ToF camera sees
/// finer) and interpolated. After light_visible_background.
void light_people(Crew& crew, const LightInput& input, const Image<float>& view_w,
                  const Image<std::uint8_t>& matte, LightLayer& light);

}  // namespace mixrig::render::cpu
