#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass focus: depth of field in three layers (method: host/render/cpu/mix/focus.h).
//   color    linear, the matte in alpha, which is passed on
//   disc     of focus_disc.frag
//   near     of focus_near.frag
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D color;
layout(binding = 1) uniform sampler2D disc;
layout(binding = 2) uniform sampler2D near;
uniform float blur_px_m;
uniform int stride_from_px;  // every second tap is taken from twice this disc radius on
layout(location = 0) out vec4 focused;

float covered(float reach, float d) { return clamp(reach + 0.5 - d, 0.0, 1.0); }

// Composites before over own over behind, each as light times share, and share.
vec3 resolve(vec4 before, vec4 own, vec4 behind) {
  float front = min(before.a, 1.0), middle = min(own.a, 1.0);
  float of_own = middle * (1.0 - front);
  float rest = behind.a > focus_no_light ? (1.0 - middle) * (1.0 - front) : 0.0;
  vec3 light = front * before.rgb / max(before.a, focus_no_light) +
               of_own * own.rgb / max(own.a, focus_no_light) +
               rest * behind.rgb / max(behind.a, focus_no_light);
  return light / max(front + of_own + rest, focus_no_light);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(color, 0);
  focused = texelFetch(color, at, 0);
  float radius = texelFetch(near, at / ivec2(focus_tile_wide, focus_tile_high), 0).r;
  if (radius <= focus_sharp_px) return;
  vec2 here = texelFetch(disc, at, 0).rg;
  float step_w = max(focus_one_surface * here.x, focus_same_blur_px / max(blur_px_m, 1e-6));
  int reach = int(ceil(radius)), stride = max(1, reach / stride_from_px);
  int first = -(reach / stride) * stride;
  float end = radius + 0.5;
  vec4 before = vec4(0), own = vec4(0), behind = vec4(0);
  for (int dy = first; dy <= reach; dy += stride) {
    int y = at.y + dy;
    if (y < 0 || y >= size.y) continue;
    for (int dx = first; dx <= reach; dx += stride) {
      int x = at.x + dx;
      float d_2 = float(dx * dx + dy * dy);
      if (x < 0 || x >= size.x || d_2 >= end * end) continue;
      vec3 there = texelFetch(disc, ivec2(x, y), 0).rgb;
      float d = sqrt(d_2), off_w = there.x - here.x;
      // Behind an edge, the room is seen through the part of the lens that the edge leaves free.
      float part = covered(off_w < -step_w ? max(there.y, here.y) : there.y, d) * there.z;
      if (part <= 0.0) continue;
      vec4 light = part * vec4(texelFetch(color, ivec2(x, y), 0).rgb, 1);
      if (off_w > step_w)
        before += light;
      else if (off_w < -step_w)
        behind += light;
      else
        own += light;
    }
  }
  float weight = float(stride * stride);
  focused.rgb = resolve(weight * before, weight * own, weight * behind);
}
