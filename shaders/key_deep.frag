#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a block: people's colour deep inside the foreground.
//   counts, colors  blocks without speckles (common/key.glsl)
//   deep    mean colour, linear, and its variance; 0 if some block around is not all foreground
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
#include "common/color.glsl"
layout(binding = 0) uniform sampler2D counts;
layout(binding = 1) uniform sampler2D colors;
out vec4 deep;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(counts, 0) - 1;
  deep = vec4(0);
  vec4 own = texelFetch(counts, at, 0);
  if (own.x == 0.0 || own.y < float(block_px)) return;
  for (int y = max(0, at.y - band_blocks); y <= min(last.y, at.y + band_blocks); ++y)
    for (int x = max(0, at.x - band_blocks); x <= min(last.x, at.x + band_blocks); ++x)
      if ((int(texelFetch(counts, ivec2(x, y), 0).w) & 1) != 0) return;
  vec4 sums = texelFetch(colors, at, 0);
  vec3 mean = sums.rgb / own.y;
  deep = vec4(mean, variance_of(mean, sums.a, own.y));
}
