#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass look: virtual colour blurred along columns, after look_along.frag.
//   across     linear, premultiplied by the coverage in alpha
//   virtual_w  1/m, 0 where not covered
//   w          of pixels that only the blur covers: of the nearest that they are blurred from
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D across;
layout(binding = 1) uniform sampler2D virtual_w;
uniform vec3 taps;
layout(location = 0) out vec4 color;
layout(location = 1) out float w;

bool is_inside(ivec2 at) {
  return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, textureSize(across, 0)));
}
vec4 color_at(ivec2 at) { return is_inside(at) ? texelFetch(across, at, 0) : vec4(0); }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  color = taps.x * color_at(at);
  for (int i = 1; i <= blur_reach; ++i)
    color += taps[i] * (color_at(at - ivec2(0, i)) + color_at(at + ivec2(0, i)));
  if (color.a < 0.5 / 255.0) discard;
  w = texelFetch(virtual_w, at, 0).r;
  if (w > 0.0) return;
  for (int j = -blur_reach; j <= blur_reach; ++j)
    for (int i = -blur_reach; i <= blur_reach; ++i)
      if (is_inside(at + ivec2(i, j)))
        w = max(w, texelFetch(virtual_w, at + ivec2(i, j), 0).r);
}
