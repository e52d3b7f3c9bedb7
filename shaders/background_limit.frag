#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass background: computes the key's limit, as prepare.cpp does for a camera that stands still.
//   row_w    largest w within `radius` along each row, 1/m
//   depth_m  of the background, 0 unknown; spread_m its sigma
//   limit_w  1/m: nearer points are foreground; no_limit_w where the background has no depth
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D row_w;
layout(binding = 1) uniform sampler2D depth_m;
layout(binding = 2) uniform sampler2D spread_m;
uniform int radius;
uniform float threshold_m, noise_factor, noise_floor_m, noise_linear, noise_quadratic_per_m;
out float limit_w;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  limit_w = no_limit_w;
  if (texelFetch(depth_m, at, 0).r <= 0.0) return;
  int last = textureSize(row_w, 0).y - 1;
  float most = 0.0;
  for (int y = max(0, at.y - radius); y <= min(last, at.y + radius); ++y)
    most = max(most, texelFetch(row_w, ivec2(at.x, y), 0).r);
  float z = 1.0 / most, spread = texelFetch(spread_m, at, 0).r;
  float sigma = noise_floor_m + z * (noise_linear + z * noise_quadratic_per_m);
  float threshold = max(threshold_m, noise_factor * sqrt(spread * spread + sigma * sigma));
  if (threshold < z) limit_w = 1.0 / (z - threshold);
}
