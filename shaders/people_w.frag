#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass shadow, one pixel a block of block_px: depth of its people.
//   matte      people, 0..1
//   visible_w  1/m, of the person where the matte is at least half; 0 unknown
//   people_w   mean, 1/m; 0 where people fill less than half of the block
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D matte;
layout(binding = 1) uniform sampler2D visible_w;
out float people_w;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * block_px;
  ivec2 last = min(first + block_px, textureSize(matte, 0));
  float sum = 0.0, count = 0.0, pixels = 0.0;
  for (int y = first.y; y < last.y; ++y)
    for (int x = first.x; x < last.x; ++x) {
      pixels += 1.0;
      float w = texelFetch(visible_w, ivec2(x, y), 0).r;
      if (w <= 0.0 || texelFetch(matte, ivec2(x, y), 0).r < person_matte) continue;
      sum += w;
      count += 1.0;
    }
  people_w = 2.0 * count >= pixels && count > 0.0 ? sum / count : 0.0;
}
