#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a tile: the matte as a line of the colour, a . c + b, by least squares over
// 5x5 tiles (He, Sun and Tang 2010).
//   counts, with_p, squares, products  of key_tiles.frag
//   line    a, b
//   people  mean of p, and of p c
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D counts;
layout(binding = 1) uniform sampler2D with_p;
layout(binding = 2) uniform sampler2D squares;
layout(binding = 3) uniform sampler2D products;
layout(location = 0) out vec4 line;
layout(location = 1) out vec4 people;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(counts, 0) - 1;
  line = people = vec4(0);
  if (texelFetch(counts, at, 0).x == 0.0) return;
  vec4 n = vec4(0), p = vec4(0), s = vec4(0), t = vec4(0);
  ivec2 from = max(at - matte_window_tiles, 0), to = min(at + matte_window_tiles, last);
  for (int y = from.y; y <= to.y; ++y)
    for (int x = from.x; x <= to.x; ++x) {
      n += texelFetch(counts, ivec2(x, y), 0);
      p += texelFetch(with_p, ivec2(x, y), 0);
      s += texelFetch(squares, ivec2(x, y), 0);
      t += texelFetch(products, ivec2(x, y), 0);
    }
  float scale = 1.0 / n.x, share = n.y * scale;
  vec3 mean = scale * vec3(n.zw, p.x);
  vec3 cov_p = scale * p.yzw - share * mean;
  float rr = scale * s.x - mean.r * mean.r + matte_spread2, rg = scale * s.y - mean.r * mean.g;
  float rb = scale * s.z - mean.r * mean.b, gg = scale * s.w - mean.g * mean.g + matte_spread2;
  float gb = scale * t.x - mean.g * mean.b, bb = scale * t.y - mean.b * mean.b + matte_spread2;
  vec3 u = vec3(gg * bb - gb * gb, gb * rb - rg * bb, rg * gb - gg * rb);
  vec3 v = vec3(u.y, rr * bb - rb * rb, rg * rb - rr * gb);
  vec3 w = vec3(u.z, v.z, rr * gg - rg * rg);
  vec3 a = (cov_p.r * u + cov_p.g * v + cov_p.b * w) / (rr * u.x + rg * u.y + rb * u.z);
  line = vec4(a, share - dot(a, mean));
  people = vec4(share, scale * p.yzw);
}
