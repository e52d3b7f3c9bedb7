#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key: fills a block with people or background; votes replace it where they decide
// (key_decide.frag).
//   band       of key_band.frag
//   matte      people, 0 or 1
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
layout(binding = 0) uniform sampler2D band;
out float matte;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  matte = texelFetch(band, at / block_px, 0).w;
}
