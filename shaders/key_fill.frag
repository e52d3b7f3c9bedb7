#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key: all of a block is a person or background, until votes decide (key_decide.frag).
//   band       of key_band.frag
//   w          1/m, sign aside; 0 unknown
//   matte      people, 0 or 1
//   visible_w  of the visible real surface, 1/m, 0 unknown
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
layout(binding = 0) uniform sampler2D band;
layout(binding = 1) uniform sampler2D w;
layout(location = 0) out float matte;
layout(location = 1) out float visible_w;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  matte = texelFetch(band, at / block_px, 0).w;
  visible_w = abs(texelFetch(w, at, 0).r);
}
