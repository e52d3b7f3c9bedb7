#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a tile near blocks where votes decide: sums over its pixels for
// key_lines.frag.
//   plate   linear light; the colour c is its square root
//   voted   matte before refinement, p
//   band    of key_band.frag
//   counts  number of pixels, sum of p, sums of c.r and c.g
//   with_p  sum of c.b, sums of c p
//   squares, products  sums of rr, rg, rb, gg; of gb, bb
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D plate;
layout(binding = 1) uniform sampler2D voted;
layout(binding = 2) uniform sampler2D band;
uniform int tile_px;
layout(location = 0) out vec4 counts;
layout(location = 1) out vec4 with_p;
layout(location = 2) out vec4 squares;
layout(location = 3) out vec4 products;

bool near_votes(ivec2 block) {
  ivec2 last = textureSize(band, 0) - 1;
  for (int y = max(0, block.y - 2); y <= min(last.y, block.y + 2); ++y)
    for (int x = max(0, block.x - 2); x <= min(last.x, block.x + 2); ++x)
      if ((int(texelFetch(band, ivec2(x, y), 0).x) & 4) != 0) return true;
  return false;
}

void main() {
  counts = with_p = squares = products = vec4(0);
  ivec2 tile = ivec2(gl_FragCoord.xy), first = tile * tile_px;
  if (!near_votes(first / block_px)) return;
  ivec2 last = min(first + tile_px, textureSize(plate, 0));
  for (int y = first.y; y < last.y; ++y)
    for (int x = first.x; x < last.x; ++x) {
      vec3 c = sqrt(texelFetch(plate, ivec2(x, y), 0).rgb);
      float p = texelFetch(voted, ivec2(x, y), 0).r;
      counts += vec4(1.0, p, c.rg);
      with_p += vec4(c.b, p * c);
      squares += vec4(c.r * c, c.g * c.g);
      products += vec4(c.g * c.b, c.b * c.b, 0.0, 0.0);
    }
}
