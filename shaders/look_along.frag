#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass look: virtual colour blurred along rows.
//   virtual_color, across  linear, premultiplied by the coverage in alpha
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D virtual_color;
uniform vec3 taps;  // weights of the pixel itself and of those 1 and 2 beside it
out vec4 across;

vec4 color_at(ivec2 at) {
  bool inside = at.x >= 0 && at.x < textureSize(virtual_color, 0).x;
  return inside ? texelFetch(virtual_color, at, 0) : vec4(0);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  across = taps.x * color_at(at);
  for (int i = 1; i <= blur_reach; ++i)
    across += taps[i] * (color_at(at - ivec2(i, 0)) + color_at(at + ivec2(i, 0)));
}
