#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light, over the blocks of light_blocks.frag: whether people hide a lamp from the background,
// where objects take light from it.
//   background_m       z in metres, 0 unknown
//   background_normal  camera axes, 0 unknown
//   background_light   of light_background.frag
//   hides              1 where people hide some lamp
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/color.glsl"
#include "common/view.glsl"
#include "common/contact.glsl"
#include "common/lamps.glsl"
layout(binding = 0) uniform sampler2D background_m;
layout(binding = 1) uniform sampler2D background_normal;
layout(binding = 2) uniform sampler2D background_light;
out float hides;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  hides = 0.0;
  float z = texelFetch(background_m, at, 0).r;
  if (z <= 0.0 || texelFetch(background_light, at, 0).r >= all_light) return;
  vec3 position_m = ray_of(at) * z, normal = normal_of(background_normal, at);
  int whole_lamps = lamp_count > 0 ? lamps[lamp_count - 1].map_size_texel.z + 1 : 0;
  for (int i = 0; i < whole_lamps && hides == 0.0; ++i)
    hides = visibility(i, true, position_m, normal) < 1.0 ? 1.0 : 0.0;
}
