#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a block: light of the room around blocks where votes decide, over the learned
// light.
//   band   of key_band.frag
//   found  of key_room_light.frag
//   light  mean of the blocks around, 1 if none is known, and the standard deviation of the room's
//          colour about it, as a part of its luminance
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D band;
layout(binding = 1) uniform sampler2D found;
out vec4 light;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(found, 0) - 1;
  light = vec4(1, 1, 1, color_flicker);
  if ((int(texelFetch(band, at, 0).x) & 4) == 0) return;
  vec3 sum = vec3(0), squares = vec3(0);
  float n = 0.0, within2 = 0.0;
  for (int y = max(0, at.y - room_light_blocks); y <= min(last.y, at.y + room_light_blocks); ++y)
    for (int x = max(0, at.x - room_light_blocks); x <= min(last.x, at.x + room_light_blocks); ++x) {
      vec4 block = texelFetch(found, ivec2(x, y), 0);
      if (block.r == 0.0) continue;
      n += 1.0;
      sum += block.rgb;
      squares += block.rgb * block.rgb;
      within2 += block.a;
    }
  if (n == 0.0) return;
  vec3 mean = sum / n;
  float change2 = within2 + max(0.0, dot(squares - mean * sum, vec3(1.0 / 3.0)));
  float prior2 = room_light_prior * color_flicker * color_flicker;
  light = vec4(mean, min(sqrt((change2 + prior2) / (n + room_light_prior)), room_light_vary));
}
