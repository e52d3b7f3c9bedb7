#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Draws a rectangle for each block that has one of the wanted flags, or for the others: passes that
// work at the border of people cost nothing elsewhere.
//   blocks  a texel a block, flags in x (such as those of key_band.frag)
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/grid.glsl"
layout(binding = 13) uniform sampler2D blocks;
uniform int wanted_flags;
uniform vec2 clip_of_block;  // a block's extent in clip space
uniform ivec4 wanted_px;     // blocks of these pixels, x0 y0 x1 y1, are wanted as well
uniform bool others;

void main() {
  ivec2 vertex = place_in_grid(gl_VertexID, 6);  // of a block, and the block's number
  ivec2 block = place_in_grid(vertex.y, textureSize(blocks, 0).x);
  int corner = vertex.x;
  vec2 opposite = vec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner >= 4);
  ivec2 first = block * block_px;
  bool wanted = (int(texelFetch(blocks, block, 0).x) & wanted_flags) != 0 ||
                (all(greaterThan(first + block_px, wanted_px.xy)) && all(lessThan(first, wanted_px.zw)));
  vec2 at = (vec2(block) + opposite) * clip_of_block - 1.0;
  gl_Position = wanted != others ? vec4(at, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
