// SPDX-License-Identifier: Apache-2.0
// One parameter struct a pass, shared by both back ends; docs/method/compositor.md describes the
// passes. Lengths are in metres; "camera" means the target camera's axes (x right, y down, z
// forward).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/glm.hpp>

#include "hal/base/srgb.h"
#include "host/math/geometry/depth_noise.h"
#include "host/render/contract/constants.h"

namespace mixrig::render {

/// Luminance of linear light.
inline float luminance(const glm::vec3& c) {
  return glm::dot(c, glm::vec3(kRec709Red, kRec709Green, kRec709Blue));
}

/// geometry::DepthNoise in single precision, as the passes compute with it.
struct NoiseParams {
  float floor_m = 0, linear = 0, quadratic_per_m = 0;
  float sigma_m(float z_m) const { return floor_m + z_m * (linear + z_m * quadratic_per_m); }
};
inline NoiseParams noise_params(const geometry::DepthNoise& noise) {
  return {static_cast<float>(noise.floor_m), static_cast<float>(noise.linear),
          static_cast<float>(noise.quadratic_per_m)};
}

/// Place of tap i of n on a panel that spans -1 to 1 along both axes: a Fibonacci lattice, in which
/// no two taps share a coordinate.
inline glm::vec2 panel_tap(int i, int n) {
  const float along = (static_cast<float>(i) + 0.5F) / static_cast<float>(n);
  const float across = kTapTurn * (static_cast<float>(i) + 0.5F);
  return {2 * along - 1, 2 * (across - std::floor(across)) - 1};
}
template <int kTaps>
std::array<glm::vec2, kTaps> panel_taps() {
  std::array<glm::vec2, kTaps> taps;
  for (int i = 0; i < kTaps; ++i) taps[static_cast<std::size_t>(i)] = panel_tap(i, kTaps);
  return taps;
}

/// Pinhole in single precision, as shaders take it.
struct PinholeParams {
  glm::vec2 focal_px{1};
  glm::vec2 center_px{0};
};

/// Pass correct, at ToF resolution: distances become z, flying pixels are removed, links are cut at
/// depth steps.
struct CorrectParams {
  bool depth_is_distance = false;
  NoiseParams noise = noise_params({});
  float step_sigmas = 6.0F;      ///< a depth step is this many standard deviations of a difference
  float step_min_m = 0.04F;      ///< and at least this
  float step_bends = 6.0F;       ///< or this many mean bends: noise on dark surfaces
  float bends_part = kSteepest;  ///< largest part of the depth that the bends make of it
  /// Pixels of a stray piece at one metre, at most: at z they are this / z^2. 0: none is looked
  /// for.
  float stray_px_m2 = 0;
};

/// Pass warp: draws the ToF grid into the view as a mesh.
struct WarpParams {
  glm::mat4 camera_from_tof{1};
  PinholeParams view;
  float open_reach = kOpenReach, shut_reach = kShutReach;
  /// Whether ToF pixels at a step that saw both surfaces, or nothing, refine the place of the
  /// border.
  bool mixed_pixels = true;
};

/// Pass agree: compares a depth camera's surfaces with the measurements of another depth camera.
struct AgreeParams {
  glm::mat4 other_from_tof{1};
  PinholeParams other;  ///< the other camera's picture without lens distortion
  float px_per_px = 1;  ///< pixels of the other camera's picture a pixel of this one's
  NoiseParams noise, other_noise;
};

/// Parallax between ToF camera and view along x and y, in pixels for each 1/m of difference of
/// inverse depth: the width of what a nearer surface hides from the ToF camera.
inline glm::vec2 parallax_px_m(const WarpParams& p) {
  return glm::abs(glm::vec2(p.camera_from_tof[3]) * p.view.focal_px);
}

/// Pass virtual: parameters of one mesh's draw.
struct VirtualParams {
  glm::mat4 camera_from_object{1};
  glm::mat3 camera_from_object_normal{1};
  glm::vec3 base_color{1};
  PinholeParams view;
};

/// A lamp in camera axes with its shadow map. A point at (x, y, z) in the lamp's axes lies at texel
/// focal * (x, y) / z + center.
struct LampParams {
  glm::vec3 position_m{0};
  glm::vec3 direction{0};  ///< zero: it shines in all directions
  float radius_m = 0;      ///< radius of a disc of the panel's area
  /// Vectors from the panel's centre to the middles of its sides, in units of radius_m, in the axes
  /// of the lamp's map.
  glm::vec3 panel_u{1, 0, 0}, panel_v{0, 1, 0};
  glm::vec3 intensity{1};
  glm::mat4 lamp_from_camera{1};
  float map_focal_texel = 1;
  float map_center_texel = 0;
  int map_size_texel = 0;    ///< 0: this lamp casts no shadow into the view
  float casters_near_m = 0;  ///< lamp z of the nearest caster; nearer points are lit
  int room_layer = -1;       ///< layer of RoomShade; -1: nothing real hides the lamp
  int part_of = 0;           ///< index of the lamp in geometry::Light::lamps
  bool is_part = false;      ///< true: a quarter of a panel
};

/// RoomShade in camera axes: a camera point p lies at cell coordinates cell_from_camera * p.
struct RoomShadeParams {
  glm::mat4 cell_from_camera{1};
  glm::ivec3 cells{0};
  float lift_m = 0;  ///< receivers are moved by this along their normal
};

/// A ContactShade, placed in this frame's camera axes.
struct ContactParams {
  glm::mat4 object_from_camera{1};
  glm::vec3 low_m{0}, high_m{0};
  float reach_m = 0;
  /// Light that the object's sides x, y, z, -x, -y, -z send to places from which they hide ambient
  /// light.
  std::array<glm::vec3, 6> sent{};
};

/// Pass light: light map of real surfaces, shading of virtual ones.
struct LightParams {
  glm::vec3 ambient{0};
  float exposure = 1;
  bool by_direction = false;  ///< objects use `ambient_terms` instead of `ambient`
  std::array<glm::vec3, kAmbientTermCount> ambient_terms{};
  glm::mat3 world_from_camera{1};
};

/// What the depth key compares with.
enum class KeyBy : std::uint8_t {
  kNothing,     ///< nobody is keyed
  kBackground,  ///< Tables::key_limit_w
  kVolume,      ///< the capture volume alone: everything inside it above its floor
};

/// Pass key: depth decides, colour where depth is in doubt.
struct KeyPassParams {
  KeyBy by = KeyBy::kNothing;
  bool color = true;
  bool refine = true;  ///< the matte follows the plate's edges; needs `color`
  bool crop = false;
  glm::mat4 world_from_camera{1};
  glm::vec3 crop_min_m{0}, crop_max_m{0};
  /// For kVolume: the floor's inverse depth is its dot product with (x/z, y/z, 1), 1/m.
  glm::vec3 floor_w{0};
  NoiseParams noise;  ///< kVolume: of one depth value
  float noise_factor = 4;
};

/// Least inverse depth (1/m) at which a point on the ray (x/z, y/z, 1) lies above the floor by more
/// than the noise; 0 where the ray does not meet the floor.
inline float volume_limit_w(const KeyPassParams& p, const glm::vec3& ray) {
  const float w = glm::dot(p.floor_w, ray);
  if (!(w > 1 / kFarthestM)) return 0;
  const float z = 1 / w;
  return 1 / std::max(z - p.noise_factor * p.noise.sigma_m(z), static_cast<float>(kNearestM));
}

}  // namespace mixrig::render
