#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass motion: blurs virtual colour by the camera's motion during the exposure.
//   virtual_color, color  linear, premultiplied by the coverage in alpha
//   virtual_w, w          1/m, 0 where not covered; where objects only pass: the nearest that
//                         the path meets
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D virtual_color;
layout(binding = 1) uniform sampler2D virtual_w;
// Motion of still points in camera axes over the exposure (CameraMotion).
uniform vec3 turn_rad, shift_m;
uniform vec2 focal_px, center_px;
uniform float nearest_w;  // inverse depth of the nearest virtual object, 1/m
layout(location = 0) out vec4 color;
layout(location = 1) out float w;

bool is_inside(ivec2 at) {
  return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, textureSize(virtual_w, 0)));
}
vec4 color_at(ivec2 at) { return is_inside(at) ? texelFetch(virtual_color, at, 0) : vec4(0); }
float w_at(ivec2 at) { return is_inside(at) ? texelFetch(virtual_w, at, 0).r : 0.0; }

vec4 color_between(vec2 at) {
  ivec2 base = ivec2(floor(at));
  vec2 t = at - vec2(base);
  vec4 top = mix(color_at(base), color_at(base + ivec2(1, 0)), t.x);
  vec4 bottom = mix(color_at(base + ivec2(0, 1)), color_at(base + ivec2(1, 1)), t.x);
  return mix(top, bottom, t.y);
}

// Computes the same as motion_px() of host/render/frame/frame_motion.h.
vec2 motion_px(vec2 px, float w_of) {
  vec2 ray = (px - center_px) / focal_px;
  vec3 moves = cross(turn_rad, vec3(ray, 1.0)) + w_of * shift_m;
  vec2 way = focal_px * (moves.xy - ray * moves.z);
  return way * min(1.0, most_motion_px / max(length(way), 1e-6));
}
int samples_of(vec2 way) {
  return clamp(int(ceil(length(way))) + 1, 1, most_motion_samples);
}
float part_of_way(int i, int samples) { return (float(i) + 0.5) / float(samples) - 0.5; }

float passing_w(vec2 px) {
  float own = w_at(ivec2(px));
  if (own > 0.0) return own;
  vec2 way = motion_px(px, nearest_w);
  int samples = samples_of(way);
  for (int i = 0; i < samples; ++i)
    own = max(own, w_at(ivec2(floor(px + part_of_way(i, samples) * way + 0.5))));
  return own;
}

void main() {
  vec2 px = floor(gl_FragCoord.xy);
  w = passing_w(px);
  if (w == 0.0) discard;
  vec2 way = motion_px(px, w);
  int samples = samples_of(way);
  color = vec4(0);
  for (int i = 0; i < samples; ++i) color += color_between(px + part_of_way(i, samples) * way);
  color /= float(samples);
  if (color.a < 0.5 / 255.0) discard;
}
