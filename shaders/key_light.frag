#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a block: light of the room around blocks where votes decide, over the learned
// light.
//   band   of key_band.frag
//   found  of key_room_light.frag
//   light  mean of the blocks around, 1 if none is known
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D band;
layout(binding = 1) uniform sampler2D found;
out vec4 light;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(found, 0) - 1;
  light = vec4(1);
  if ((int(texelFetch(band, at, 0).x) & 4) == 0) return;
  vec4 sum = vec4(0);
  for (int y = max(0, at.y - room_light_blocks); y <= min(last.y, at.y + room_light_blocks); ++y)
    for (int x = max(0, at.x - room_light_blocks); x <= min(last.x, at.x + room_light_blocks); ++x)
      sum += texelFetch(found, ivec2(x, y), 0);
  if (sum.a > 0.0) light = sum / sum.a;
}
