#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass mix, drawn for blocks without people and virtual objects: mix.frag for a matte of 0.
//   plate         linear light
//   visible_w     visible real surface, 1/m, 0 unknown
//   background_m  z in metres, 0 unknown
//   light_map     0..1
//   color, mixed_m, segmented_m, layer  as in mix.frag
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D plate;
layout(binding = 2) uniform sampler2D visible_w;
layout(binding = 3) uniform sampler2D background_m;
layout(binding = 5) uniform sampler2D light_map;
uniform bool has_background, has_light;
layout(location = 0) out vec4 color;
layout(location = 1) out float mixed_m;
layout(location = 2) out float segmented_m;
layout(location = 3) out float layer;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float light = has_light ? texelFetch(light_map, at, 0).r : 1.0;
  color = vec4(texelFetch(plate, at, 0).rgb * light, 0.0);
  mixed_m = has_background ? texelFetch(background_m, at, 0).r : 0.0;
  if (mixed_m <= 0.0) {
    float w = abs(texelFetch(visible_w, at, 0).r);
    mixed_m = w > 0.0 ? 1.0 / w : 0.0;
  }
  segmented_m = 0.0;
  layer = 0.0;
}
