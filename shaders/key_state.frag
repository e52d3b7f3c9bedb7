#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, by depth: foreground before the limit, background at or behind it.
//   w        1/m, sign aside; 0 unknown
//   limit_w  1/m, infinite where the background has no depth
//   state    render::PixelState / 255; edge means doubt
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
layout(binding = 0) uniform sampler2D w;
layout(binding = 1) uniform sampler2D limit_w;
uniform bool crop;
uniform mat4 world_from_camera;
uniform vec3 crop_min_m, crop_max_m;
uniform vec2 focal_px, center_px;
out float state;

bool outside_box(ivec2 at, float measured_w) {
  vec3 ray = vec3((vec2(at) - center_px) / focal_px, 1.0);
  vec3 world = (world_from_camera * vec4(ray / measured_w, 1.0)).xyz;
  return any(lessThan(world, crop_min_m)) || any(greaterThan(world, crop_max_m));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float measured = abs(texelFetch(w, at, 0).r), limit = texelFetch(limit_w, at, 0).r;
  int s = unknown;
  if (measured > 0.0)
    s = limit < no_limit_w ? (measured > limit ? foreground : background) : doubt;
  if (crop && s >= foreground && outside_box(at, measured)) s = background;
  state = float(s) / 255.0;
}
