#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass focus: largest radius in each tile.
//   disc  of focus_disc.frag
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D disc;
layout(location = 0) out float radius_px;

void main() {
  ivec2 tile = ivec2(focus_tile_wide, focus_tile_high);
  ivec2 first = ivec2(gl_FragCoord.xy) * tile, end = min(first + tile, textureSize(disc, 0));
  radius_px = 0.0;
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x)
      radius_px = max(radius_px, texelFetch(disc, ivec2(x, y), 0).g);
}
