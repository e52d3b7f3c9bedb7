#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, by depth: points nearer than the limit are foreground, the others background.
//   w        1/m, sign aside; 0 unknown
//   limit_w  1/m, negative or infinite without background depth; and, for a still camera, what lies
//            behind a mirror (Tables::hole_behind_w); not read if the volume alone keys
//   state    as in common/key.glsl; edge means doubt
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
layout(binding = 0) uniform sampler2D w;
layout(binding = 1) uniform sampler2D limit_w;
uniform bool crop;
uniform mat4 world_from_camera;
uniform vec3 crop_min_m, crop_max_m;
uniform vec2 focal_px, center_px;
uniform bool by_volume;
uniform vec3 floor_w;  // 1/m: the floor's inverse depth is its dot product with a ray
uniform float noise_factor, noise_floor_m, noise_linear, noise_quadratic_per_m;
out float state;

vec3 ray_of(ivec2 at) { return vec3((vec2(at) - center_px) / focal_px, 1.0); }

bool outside_box(ivec2 at, float measured_w) {
  vec3 ray = ray_of(at);
  vec3 world = (world_from_camera * vec4(ray / measured_w, 1.0)).xyz;
  return any(lessThan(world, crop_min_m)) || any(greaterThan(world, crop_max_m));
}

float volume_limit_w(vec3 ray) {
  float w = dot(floor_w, ray);
  if (w <= 1.0 / farthest_m) return 0.0;
  float z = 1.0 / w;
  float sigma_m = noise_floor_m + z * (noise_linear + z * noise_quadratic_per_m);
  return 1.0 / max(z - noise_factor * sigma_m, nearest_m);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float measured = abs(texelFetch(w, at, 0).r);
  vec2 limits = by_volume ? vec2(volume_limit_w(ray_of(at)), 0.0) : texelFetch(limit_w, at, 0).rg;
  float limit = limits.x;
  int s = unknown;
  bool learned = limit > 0.0 && limit < no_limit_w;
  bool behind = learned || measured < limits.y;
  if (measured > 0.0) s = measured > abs(limit) ? foreground : behind ? background : doubt;
  if (crop && s >= foreground && outside_box(at, measured)) s = background;
  if (measured > 0.0 && measured < limits.y) s += state_mirrored;
  state = float(s) / 255.0;
}
