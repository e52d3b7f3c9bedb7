#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light: blends the light of people over the background's by the matte, in blocks that may
// show people.
//   matte               people, 0..1
//   tile_w, tile_light  of light_tile_w.frag and light_tiles.frag
//   light               0..1, and the matte as alpha
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D matte;
layout(binding = 1) uniform sampler2D tile_w;
layout(binding = 2) uniform sampler2D tile_light;
out vec4 light;

// Bilinear over the tiles that contain people; 1 if none does.
float people_light(ivec2 at) {
  vec2 tile = (vec2(at) - 0.5 * float(light_tile_px - 1)) / float(light_tile_px);
  ivec2 first = ivec2(floor(tile)), last = textureSize(tile_w, 0) - 1;
  float sum = 0.0, weights = 0.0;
  for (int j = max(first.y, 0); j <= min(first.y + 1, last.y); ++j)
    for (int i = max(first.x, 0); i <= min(first.x + 1, last.x); ++i) {
      if (texelFetch(tile_w, ivec2(i, j), 0).r <= 0.0) continue;
      float weight = (1.0 - abs(tile.x - float(i))) * (1.0 - abs(tile.y - float(j)));
      sum += weight * texelFetch(tile_light, ivec2(i, j), 0).r;
      weights += weight;
    }
  return weights > 0.0 ? sum / weights : 1.0;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float share = texelFetch(matte, at, 0).r;
  if (share <= 0.0) discard;
  light = vec4(clamp(people_light(at), 0.0, 1.0), 0.0, 0.0, share);
}
