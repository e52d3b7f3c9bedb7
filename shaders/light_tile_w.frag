#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light, one pixel a tile: depth of its people. No ToF camera resolves finer than a tile.
//   matte      people, 0..1
//   visible_w  1/m, of the person where the matte is at least half; 0 unknown
//   tile_w     mean, 1/m; 0 without people
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D matte;
layout(binding = 1) uniform sampler2D visible_w;
out float tile_w;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * light_tile_px;
  ivec2 last = min(first + light_tile_px, textureSize(matte, 0));
  float sum = 0.0, count = 0.0;
  for (int y = first.y; y < last.y; ++y)
    for (int x = first.x; x < last.x; ++x) {
      float w = texelFetch(visible_w, ivec2(x, y), 0).r;
      if (w <= 0.0 || texelFetch(matte, ivec2(x, y), 0).r < person_matte) continue;
      sum += w;
      count += 1.0;
    }
  tile_w = count > 0.0 ? sum / count : 0.0;
}
