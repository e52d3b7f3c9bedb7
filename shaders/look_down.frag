#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass look: filters virtual colour along columns, after look_along.frag.
//   across     brightness, red - brightness, blue - brightness, coverage
//   color      linear, premultiplied by the coverage in alpha
//   virtual_w  1/m, 0 where not covered
//   w          1/m; pixels that only the blur covers have that of the nearest pixel it reaches
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/color.glsl"
layout(binding = 0) uniform sampler2D across;
layout(binding = 1) uniform sampler2D virtual_w;
uniform vec3 light_taps, chroma_taps;
layout(location = 0) out vec4 color;
layout(location = 1) out float w;

bool is_inside(ivec2 at) {
  return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, textureSize(across, 0)));
}
vec4 color_at(ivec2 at) { return is_inside(at) ? texelFetch(across, at, 0) : vec4(0); }
vec4 weights(int i) {
  return vec4(light_taps[i], chroma_taps[i], chroma_taps[i], light_taps[i]);
}

// Computes the same as from_differences() of host/render/frame/picture_look.h.
vec4 from_differences(vec4 d) {
  vec3 share = vec3(luminance(vec3(1, 0, 0)), luminance(vec3(0, 1, 0)), luminance(vec3(0, 0, 1)));
  float green = -(share.r * d.y + share.b * d.z) / share.g;
  return vec4(max(d.x + vec3(d.y, green, d.z), 0.0), d.w) / max(d.w, 1.0);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 sum = weights(0) * color_at(at);
  for (int i = 1; i <= blur_reach; ++i)
    sum += weights(i) * (color_at(at - ivec2(0, i)) + color_at(at + ivec2(0, i)));
  color = from_differences(sum);
  if (color.a < 0.5 / 255.0) discard;
  w = texelFetch(virtual_w, at, 0).r;
  if (w > 0.0) return;
  for (int j = -blur_reach; j <= blur_reach; ++j)
    for (int i = -blur_reach; i <= blur_reach; ++i)
      if (is_inside(at + ivec2(i, j)))
        w = max(w, texelFetch(virtual_w, at + ivec2(i, j), 0).r);
}
