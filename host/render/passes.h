// SPDX-License-Identifier: Apache-2.0
// One parameter struct a pass, shared by both back ends; README.md describes the passes.
// Lengths in metres, "camera" means the target camera's axes (x right, y down, z forward).
#pragma once

#include <array>
#include <cmath>

#include <glm/glm.hpp>

namespace mixrig::render {

inline constexpr int kBlockPx = 8;       ///< side of the key's blocks
inline constexpr int kLightTilePx = 4;   ///< people's light is found once in such a tile
inline constexpr int kBlockerTaps = 12;  ///< of the search for shadow casters
inline constexpr int kShadowTaps = 24;   ///< of the shadow filter

/// An object this far behind the background still touches it: noise of the learned depth.
inline constexpr float kContactSlackM = 0.02F;

/// Tap i of n on the unit disc: evenly spread along a spiral (Vogel 1979).
inline glm::vec2 vogel_tap(int i, int n) {
  const float radius = std::sqrt((static_cast<float>(i) + 0.5F) / static_cast<float>(n));
  const float angle = 2.39996323F * static_cast<float>(i);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}
template <int kTaps>
std::array<glm::vec2, kTaps> vogel_disc() {
  std::array<glm::vec2, kTaps> taps;
  for (int i = 0; i < kTaps; ++i) taps[static_cast<std::size_t>(i)] = vogel_tap(i, kTaps);
  return taps;
}

/// Pinhole as shaders take it.
struct PinholeParams {
  glm::vec2 focal_px{1};
  glm::vec2 center_px{0};
};

/// Distance to z, flying pixels out, cuts at depth steps. ToF resolution.
struct CorrectParams {
  bool depth_is_distance = false;
  float noise_floor_m = 0.005F, noise_linear = 0.002F, noise_quadratic_per_m = 0.001F;
  float step_sigmas = 6.0F;  ///< a depth step is this many standard deviations of a difference
  float step_min_m = 0.04F;  ///< and at least this
  float step_bends = 6.0F;   ///< or this many mean bends: noise on dark surfaces
};

/// ToF grid to view as a mesh.
struct WarpParams {
  glm::mat4 camera_from_tof{1};
  PinholeParams view;
};

/// Virtual objects: one draw per mesh.
struct VirtualParams {
  glm::mat4 camera_from_object{1};
  glm::mat3 camera_from_object_normal{1};
  glm::vec3 base_color{1};
  PinholeParams view;
};

/// A lamp in camera axes with its shadow map; map texel = focal * x/z + center, z along axis.
struct LampParams {
  glm::vec3 position_m{0};
  glm::vec3 direction{0};  ///< zero for all directions
  float radius_m = 0;      ///< of a disc of the panel's area
  glm::vec3 intensity{1};
  glm::mat4 lamp_from_camera{1};
  float map_focal_texel = 1;
  float map_center_texel = 0;
  int map_size_texel = 0;    ///< 0: this lamp throws no shadow into the view
  float casters_near_m = 0;  ///< lamp z of the nearest caster: what is nearer is lit
};

/// Light map of real surfaces, shading of virtual ones.
struct LightParams {
  glm::vec3 ambient{0};
  float exposure = 1;
};

/// Depth key with doubt decided by colour.
struct KeyPassParams {
  float threshold_m = 0.05F;
  float noise_factor = 4.0F;
  float noise_floor_m = 0.005F, noise_linear = 0.002F, noise_quadratic_per_m = 0.001F;
  bool color = true;
  bool crop = false;
  glm::mat4 world_from_camera{1};
  glm::vec3 crop_min_m{0}, crop_max_m{0};
};

}  // namespace mixrig::render
