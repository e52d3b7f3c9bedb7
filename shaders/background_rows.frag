#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass background, limit of the key: the nearest surface within `radius` along a row.
//   w      1/m, sign aside, 0 unknown
//   most_w largest w within the radius
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D w;
uniform int radius;
out float most_w;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int last = textureSize(w, 0).x - 1;
  most_w = 0.0;
  for (int x = max(0, at.x - radius); x <= min(last, at.x + radius); ++x)
    most_w = max(most_w, abs(texelFetch(w, ivec2(x, at.y), 0).r));
}
