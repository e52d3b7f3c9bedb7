#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass focus: 1/z in focus, by the median of the known depths around a pixel. If none is known, the
// target keeps its content.
//   mixed_m  z in metres, 0 unknown
//   plane_w  1/z
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D mixed_m;
uniform ivec2 pixel;
layout(location = 0) out float plane_w;

void main() {
  float known[25];
  int count = 0;
  ivec2 size = textureSize(mixed_m, 0);
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      ivec2 at = pixel + ivec2(dx, dy);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
      float z = texelFetch(mixed_m, at, 0).r;
      if (z <= 0.0) continue;
      int place = count++;
      for (; place > 0 && known[place - 1] > 1.0 / z; --place) known[place] = known[place - 1];
      known[place] = 1.0 / z;
    }
  if (count == 0) discard;
  plane_w = known[count / 2];
}
