#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass virtual: makes the edges of shaded objects as wide as those of the plate.
//   sharp_color, color  linear, premultiplied by the coverage in alpha
//   sharp_w, w          1/m, 0 where not covered
// A pixel that only the filter covers shows the surface of the one beside it that is covered most.
// Coverage stays on its side of virtual_share, by a level of 1/255.
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D sharp_color;
layout(binding = 1) uniform sampler2D sharp_w;
uniform float edge_tap;  // weight of each of the four pixels beside one
layout(location = 0) out vec4 color;
layout(location = 1) out float w;

const ivec2 kBeside[4] = ivec2[4](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(sharp_color, 0) - 1, from = at;
  vec4 own = texelFetch(sharp_color, at, 0), most = own;
  float more = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 beside = clamp(at + kBeside[i], ivec2(0), last);
    vec4 c = texelFetch(sharp_color, beside, 0);
    more += c.a - own.a;
    if (own.a == 0.0 && c.a > most.a) most = c, from = beside;
  }
  if (most.a == 0.0) discard;
  float soft = own.a + edge_tap * more, level = 1.0 / 255.0;
  soft = own.a < virtual_share ? min(soft, virtual_share - level) : max(soft, virtual_share + level);
  color = most * (soft / most.a);
  w = texelFetch(sharp_w, from, 0).r;
}
