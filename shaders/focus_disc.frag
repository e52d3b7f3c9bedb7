#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass focus: the disc of each pixel.
//   mixed_m  z in metres, 0 unknown
//   plane_w  one texel: 1/z in focus
//   area     pixels that a disc covers, by radius
//   disc     1/z (without depth, that of the pixel to the left), radius in pixels, 1 / area
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D mixed_m;
layout(binding = 1) uniform sampler2D plane_w;
layout(binding = 2) uniform sampler2D area;
uniform float blur_px_m, most_radius_px;
layout(location = 0) out vec4 disc;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float sharp_w = texelFetch(plane_w, ivec2(0), 0).r, w = sharp_w;
  for (; at.x >= 0; --at.x) {
    float z = texelFetch(mixed_m, at, 0).r;
    if (z <= 0.0) continue;
    w = 1.0 / z;
    break;
  }
  float radius = min(blur_px_m * abs(w - sharp_w), most_radius_px);
  if (radius < focus_sharp_px) radius = 0.5;
  int step = int(radius * float(focus_area_steps) + 0.5);
  disc = vec4(w, radius, 1.0 / texelFetch(area, ivec2(step, 0), 0).r, 0);
}
