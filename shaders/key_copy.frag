#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key: the outputs of key_matte.frag where votes decide nothing.
//   band       of key_band.frag
//   w          1/m, negative where a cut cell drew it; 0 unknown
//   matte      people, 0..1
//   visible_w  inverse depth of the visible real surface, 1/m, 0 unknown
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D band;
layout(binding = 1) uniform sampler2D w;
layout(location = 0) out float matte;
layout(location = 1) out float visible_w;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  matte = texelFetch(band, at / block_px, 0).w;
  visible_w = abs(texelFetch(w, at, 0).r);
}
