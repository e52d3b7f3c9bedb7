#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass correct, first step: turns the ToF camera's values into z.
//   depth_m  metres along z or along the ray; anything but a positive number is unknown
//   tof_ray  (x/z, y/z); NaN where the lens has no ray
//   z_m      metres, 0 unknown
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D depth_m;
layout(binding = 1) uniform sampler2D tof_ray;
uniform bool depth_is_distance;
out float z_m;

// Positive floats order like their bits, with NaN past infinity: no GPU may fold this test away.
bool is_known(float z) {
  int bits = floatBitsToInt(z);
  return bits > 0 && bits < floatBitsToInt(farthest_m);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(depth_m, at, 0).r;
  vec2 ray = texelFetch(tof_ray, at, 0).xy;
  bool has_ray = (floatBitsToInt(ray.x) & 0x7fffffff) < 0x7f800000;
  float z = depth_is_distance ? depth / sqrt(1.0 + dot(ray, ray)) : depth;
  z_m = has_ray && is_known(depth) && is_known(z) ? z : 0.0;
}
