// SPDX-License-Identifier: Apache-2.0
// One parameter struct a pass, shared by both back ends; docs/method/compositor.md
// describes the passes.
// Lengths in metres, "camera" means the target camera's axes (x right, y down, z forward).
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

/// Tap i of n on a panel that reaches from -1 to 1 along both axes: a Fibonacci lattice, no two of
/// which hide behind each other.
inline glm::vec2 panel_tap(int i, int n) {
  const float along = (static_cast<float>(i) + 0.5F) / static_cast<float>(n);
  const float across = 0.61803399F * (static_cast<float>(i) + 0.5F);
  return {2 * along - 1, 2 * (across - std::floor(across)) - 1};
}
template <int kTaps>
std::array<glm::vec2, kTaps> panel_taps() {
  std::array<glm::vec2, kTaps> taps;
  for (int i = 0; i < kTaps; ++i) taps[static_cast<std::size_t>(i)] = panel_tap(i, kTaps);
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
  NoiseParams noise = noise_params({});
  float step_sigmas = 6.0F;      ///< a depth step is this many standard deviations of a difference
  float step_min_m = 0.04F;      ///< and at least this
  float step_bends = 6.0F;       ///< or this many mean bends: noise on dark surfaces
  float bends_part = kSteepest;  ///< largest part of the depth that the bends make of it
  /// Pixels of a stray piece at one metre, at most: at z they are this / z^2. 0: none is looked for.
  float stray_px_m2 = 0;
};

/// ToF grid to view as a mesh.
struct WarpParams {
  glm::mat4 camera_from_tof{1};
  PinholeParams view;
  float open_reach = kOpenReach, shut_reach = kShutReach;
  /// At a step, pixels that saw both surfaces, or nothing, tell where its border lies.
  bool mixed_pixels = true;
};

/// A depth camera's surfaces against what another one measured there.
struct AgreeParams {
  glm::mat4 other_from_tof{1};
  PinholeParams other;  ///< the other one's picture without its lens
  float px_per_px = 1;  ///< pixels of the other one's picture a pixel of that
  NoiseParams noise, other_noise;
};

/// Pixels, along x and y, that a point moves against one behind it when seen from the ToF camera,
/// for each 1/m between their inverse depths: so wide is what the nearer one hides from it.
inline glm::vec2 parallax_px_m(const WarpParams& p) {
  return glm::abs(glm::vec2(p.camera_from_tof[3]) * p.view.focal_px);
}

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
  /// From its middle to those of its sides, in radii, axes of the lamp's map.
  glm::vec3 panel_u{1, 0, 0}, panel_v{0, 1, 0};
  glm::vec3 intensity{1};
  glm::mat4 lamp_from_camera{1};
  float map_focal_texel = 1;
  float map_center_texel = 0;
  int map_size_texel = 0;    ///< 0: this lamp casts no shadow into the view
  float casters_near_m = 0;  ///< lamp z of the nearest caster: what is nearer is lit
  int room_layer = -1;       ///< of RoomShade; -1: nothing real hides the lamp
  int part_of = 0;           ///< which of geometry::Light::lamps it is, or belongs to
  bool is_part = false;      ///< a quarter of a panel
};

/// RoomShade in camera axes: cell = cell_from_camera * p.
struct RoomShadeParams {
  glm::mat4 cell_from_camera{1};
  glm::ivec3 cells{0};
  float lift_m = 0;  ///< of a receiver along its normal
};

/// A ContactShade in this frame.
struct ContactParams {
  glm::mat4 object_from_camera{1};
  glm::vec3 low_m{0}, high_m{0};
  float reach_m = 0;
  /// Light of the object's sides x, y, z, -x, -y, -z on what they hide ambient light from.
  std::array<glm::vec3, 6> sent{};
};

/// Light map of real surfaces, shading of virtual ones.
struct LightParams {
  glm::vec3 ambient{0};
  float exposure = 1;
  bool by_direction = false;  ///< on objects: these AmbientTerms instead of `ambient`
  std::array<glm::vec3, kAmbientTermCount> ambient_terms{};
  glm::mat3 world_from_camera{1};
};

/// What the depth key compares with.
enum class KeyBy : std::uint8_t {
  kNothing,     ///< nobody is keyed
  kBackground,  ///< Tables::key_limit_w
  kVolume,      ///< the capture volume alone: everything in it over its floor
};

/// Depth key with doubt decided by colour.
struct KeyPassParams {
  KeyBy by = KeyBy::kNothing;
  bool color = true;
  bool refine = true;  ///< the matte follows the plate's edges; needs color
  bool crop = false;
  glm::mat4 world_from_camera{1};
  glm::vec3 crop_min_m{0}, crop_max_m{0};
  glm::vec3 floor_w{0};  ///< kVolume: floor's inverse depth, 1/m, is its product with (x/z, y/z, 1)
  NoiseParams noise;     ///< kVolume: of a measurement
  float noise_factor = 4;
};

/// Inverse depth from which on a ray (x/z, y/z, 1) shows something over the floor; 0 where it does
/// not meet the floor.
inline float volume_limit_w(const KeyPassParams& p, const glm::vec3& ray) {
  const float w = glm::dot(p.floor_w, ray);
  if (!(w > 1 / kFarthestM)) return 0;
  const float z = 1 / w;
  return 1 / std::max(z - p.noise_factor * p.noise.sigma_m(z), static_cast<float>(kNearestM));
}

}  // namespace mixrig::render
