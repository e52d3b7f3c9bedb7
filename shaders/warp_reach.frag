#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass warp: how far the surface of each ToF pixel is extended towards its four neighbours.
//   vertices  from correct_links.frag
//   tof_ray   (x/z, y/z) of a ToF pixel
//   raw_z_m   metres, as measured, 0 unknown
//   reaches   half steps left, right, up, down: 1 where linked
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/tof.glsl"
#include "common/mesh.glsl"
layout(binding = 2) uniform sampler2D raw_z_m;
uniform vec2 focal_px, center_px;
uniform float open_reach_now, shut_reach_now;
uniform bool mixed_pixels;
out vec4 reaches;

// Place in the view, px from its centre.
vec2 place_px(vec2 ray, float w) {
  vec3 q = (camera_from_tof * vec4(ray, 1.0, w)).xyz;
  return q.z > 0.0 ? focal_px * q.xy / q.z : vec2(0.0);
}

// Extension past the sample, in half steps, by whether the view sees a gap or an overlap there.
float by_sight(vec2 ray, vec2 half_step, float w, float other_w) {
  vec2 border = place_px(ray + half_step, w), out_px = border - place_px(ray, w);
  float opens_px = dot(place_px(ray + half_step, other_w) - border, out_px) /
                   max(length(out_px), 1e-6);
  float part = min(1.0, abs(opens_px) / reach_ramp_px);
  return 1.0 + part * ((opens_px > 0.0 ? open_reach_now : shut_reach_now) - 1.0);
}

// Whether two neighbours along x or y are linked.
bool linked(ivec2 at, ivec2 d) {
  ivec2 from = d.x + d.y > 0 ? at : at + d;
  if (any(lessThan(from, ivec2(0))) || any(greaterThanEqual(from, textureSize(vertices, 0))))
    return false;
  return (int(texelFetch(vertices, from, 0).a) & (d.x != 0 ? 1 : 2)) != 0;
}

// Share of the nearer surface in a pixel at a step, from its measurement: `pure` if it saw one
// surface, or a depth that is neither of them nor between.
float near_share(float z, float near, float far, float pure) {
  if (z <= 0.0) return hole_share;
  float by_phase = (far - z) / (far - near);
  if (by_phase < -share_slack || by_phase > 1.0 + share_slack) return pure;
  // Amplitudes fall with the square of the distance.
  float part = clamp(by_phase, 0.0, 1.0);
  float by_near = part * near * near, by_far = (1.0 - part) * far * far;
  float share = by_near / (by_near + by_far);
  return abs(share - pure) < mixed_share ? pure : share;
}

// By how much the border of the nearer surface lies farther out than midway, in half steps.
float border_shift(float near, float far, float near_z, float far_z) {
  if (far - near < share_part_of_depth * near) return 0.0;
  return 2.0 * (near_share(near_z, near, far, 1.0) + near_share(far_z, near, far, 0.0) - 1.0);
}

// Half steps by which the surface of pixel `at` is extended towards its neighbour in direction d,
// which may lie outside the picture.
float reach(ivec2 at, ivec2 d, float w, vec2 ray, vec2 half_step) {
  ivec2 beside = at + d;
  if (any(lessThan(beside, ivec2(0))) || any(greaterThanEqual(beside, textureSize(vertices, 0))) ||
      linked(at, d))
    return 1.0;
  float other_w = value_at(vertices, beside);
  float sight = other_w >= w ? 1.0 : by_sight(ray, half_step, w, other_w);
  if (!mixed_pixels || other_w <= 0.0) return sight;
  // Depths by the samples behind, which saw one surface each.
  float own_z = 1.0 / (linked(at, -d) ? value_at(vertices, at - d) : w);
  float other_z = 1.0 / (linked(beside, d) ? value_at(vertices, beside + d) : other_w);
  float own_raw = value_at(raw_z_m, at), other_raw = value_at(raw_z_m, beside);
  float shift = own_z < other_z ? border_shift(own_z, other_z, own_raw, other_raw)
                                : -border_shift(other_z, own_z, other_raw, own_raw);
  return clamp(sight + shift, 0.0, most_reach);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float w = texelFetch(vertices, at, 0).x;
  vec4 to = vec4(1);
  reaches = to;
  if (w <= 0.0) return;
  vec2 ray = texelFetch(tof_ray, at, 0).xy;
  // A loop keeps one copy of reach() in the program.
  for (int i = 0; i < 4; ++i) {
    ivec2 d = (i & 1) == 0 ? ivec2(-1) : ivec2(1);
    d *= i < 2 ? ivec2(1, 0) : ivec2(0, 1);
    to[i] = reach(at, d, w, ray, half_step(at, ray, d));
  }
  reaches = to;
}
