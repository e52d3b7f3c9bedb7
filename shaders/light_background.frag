#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light: light that the empty room keeps beside the virtual objects.
//   background_m       z in metres, 0 unknown
//   background_normal  camera axes, 0 unknown
//   light              0..1, 1 without background
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/color.glsl"
#include "common/view.glsl"
#include "common/contact.glsl"
#include "common/lamps.glsl"
layout(binding = 0) uniform sampler2D background_m;
layout(binding = 1) uniform sampler2D background_normal;
out float light;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float z = texelFetch(background_m, at, 0).r;
  light = 1.0;
  if (z <= 0.0) return;
  light = clamp(light_ratio(ray_of(at) * z, normal_of(background_normal, at)), 0.0, 1.0);
}
