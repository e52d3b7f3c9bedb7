#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Draws a rectangle for each block that has one of the wanted flags: passes that work at the border
// of people cost nothing elsewhere.
//   blocks  a texel a block, flags in x (such as those of key_band.frag)
#include "common/precision.glsl"
layout(binding = 13) uniform sampler2D blocks;
uniform int wanted_flags;
uniform vec2 clip_of_block;  // a block's extent in clip space

void main() {
  int width = textureSize(blocks, 0).x, id = gl_VertexID / 6;
  ivec2 block = ivec2(id % width, id / width);
  ivec2 corners[6] = ivec2[](ivec2(0, 0), ivec2(1, 0), ivec2(1, 1),  //
                             ivec2(0, 0), ivec2(1, 1), ivec2(0, 1));
  bool wanted = (int(texelFetch(blocks, block, 0).x) & wanted_flags) != 0;
  vec2 at = vec2(block + corners[gl_VertexID % 6]) * clip_of_block - 1.0;
  gl_Position = wanted ? vec4(at, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
