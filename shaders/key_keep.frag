#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key: copies the images that the next frame needs.
//   plate         linear light, view
//   matte         people, 0..1
//   kept_plate, kept_matte  copies of these
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D plate;
layout(binding = 1) uniform sampler2D matte;
layout(location = 0) out vec4 kept_plate;
layout(location = 1) out float kept_matte;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  kept_plate = texelFetch(plate, at, 0);
  kept_matte = texelFetch(matte, at, 0).r;
}
