#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass focus: largest radius within `reach` tiles around each tile.
//   tiles  of focus_tiles.frag
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D tiles;
uniform ivec2 reach;
layout(location = 0) out float radius_px;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 first = max(at - reach, ivec2(0)), last = min(at + reach, textureSize(tiles, 0) - 1);
  radius_px = 0.0;
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x)
      radius_px = max(radius_px, texelFetch(tiles, ivec2(x, y), 0).r);
}
