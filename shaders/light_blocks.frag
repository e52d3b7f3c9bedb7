#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light, one pixel a block: where objects take light from the empty room.
//   background_light  of light_background.frag
//   taken             1 if some pixel of the block has less than all light
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D background_light;
out float taken;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * block_px;
  ivec2 last = min(first + block_px, textureSize(background_light, 0));
  float least = 1.0;
  for (int y = first.y; y < last.y; ++y)
    for (int x = first.x; x < last.x; ++x)
      least = min(least, texelFetch(background_light, ivec2(x, y), 0).r);
  taken = least < all_light ? 1.0 : 0.0;
}
