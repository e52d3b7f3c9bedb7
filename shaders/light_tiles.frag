#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light, one pixel a tile: light of the people in it.
//   tile_w      of light_tile_w.frag
//   tile_light  0..1; 1 without people
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/color.glsl"
#include "common/view.glsl"
#include "common/contact.glsl"
#include "common/lamps.glsl"
layout(binding = 0) uniform sampler2D tile_w;
uniform int reach;  // tiles: two ToF footprints
out float tile_light;

float w_at(ivec2 tile) {
  ivec2 size = textureSize(tile_w, 0);
  bool inside = all(greaterThanEqual(tile, ivec2(0))) && all(lessThan(tile, size));
  return inside ? texelFetch(tile_w, tile, 0).r : 0.0;
}

// Normal from the slope of w between tiles; towards the camera if unknown.
vec3 person_normal(ivec2 tile, vec3 ray, float w) {
  ivec2 dx = ivec2(reach, 0), dy = ivec2(0, reach);
  float left = w_at(tile - dx), right = w_at(tile + dx);
  float above = w_at(tile - dy), below = w_at(tile + dy);
  if (min(min(left, right), min(above, below)) <= 0.0) return -normalize(ray);
  float per_px = 0.5 / float(reach * light_tile_px);
  vec2 slope = vec2(right - left, below - above) * per_px * focal_px;
  return -normalize(vec3(slope, w - dot(slope, ray.xy)));
}

void main() {
  ivec2 tile = ivec2(gl_FragCoord.xy);
  float w = w_at(tile);
  tile_light = 1.0;
  if (w <= 0.0) return;
  vec2 center = vec2(tile * light_tile_px) + 0.5 * float(light_tile_px - 1);
  vec3 ray = vec3((center - center_px) / focal_px, 1.0);
  tile_light = light_ratio(ray / w, person_normal(tile, ray, w));
}
