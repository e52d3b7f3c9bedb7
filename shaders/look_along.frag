#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass look: filters virtual colour along rows.
//   virtual_color  linear, premultiplied by the coverage in alpha
//   across         filtered, as brightness, red - brightness, blue - brightness, coverage
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/color.glsl"
layout(binding = 0) uniform sampler2D virtual_color;
// Weights of the pixel itself and of those 1 and 2 beside it: for brightness and coverage, and for
// colour differences.
uniform vec3 light_taps, chroma_taps;
out vec4 across;

vec4 color_at(ivec2 at) {
  bool inside = at.x >= 0 && at.x < textureSize(virtual_color, 0).x;
  if (!inside) return vec4(0);
  vec4 c = texelFetch(virtual_color, at, 0);
  float y = luminance(c.rgb);
  return vec4(y, c.r - y, c.b - y, c.a);
}
vec4 weights(int i) {
  return vec4(light_taps[i], chroma_taps[i], chroma_taps[i], light_taps[i]);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  across = weights(0) * color_at(at);
  for (int i = 1; i <= blur_reach; ++i)
    across += weights(i) * (color_at(at - ivec2(i, 0)) + color_at(at + ivec2(i, 0)));
}
