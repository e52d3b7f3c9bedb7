#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass background: learned colours at the places where the exposure is measured.
//   places   view pixel of each place, one a texel
//   learned  linear light, red negative where unknown
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D places;
layout(binding = 1) uniform sampler2D learned;
out vec4 color;

void main() {
  ivec2 at = ivec2(texelFetch(places, ivec2(gl_FragCoord.xy), 0).xy + 0.5);
  color = texelFetch(learned, at, 0);
}
