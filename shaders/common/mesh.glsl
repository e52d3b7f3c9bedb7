// SPDX-License-Identifier: Apache-2.0
// Pass warp: functions shared by its steps. Needs common/precision.glsl.
layout(binding = 0) uniform sampler2D vertices;
layout(binding = 1) uniform sampler2D tof_ray;
uniform mat4 camera_from_tof;

// Half a step of the ray towards the neighbour in direction d; 0 if that has no ray.
vec2 half_step(ivec2 at, vec2 ray, ivec2 d) {
  vec2 other = texelFetch(tof_ray, at + d, 0).xy;
  bool is_nan = (floatBitsToInt(other.x) & 0x7fffffff) > 0x7f800000;
  return is_nan ? vec2(0) : 0.5 * (other - ray);
}
