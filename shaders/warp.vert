#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass warp, second half: a vertex of the ToF mesh (ids as in cells.comp) into the view.
//   tof_ray   (x/z, y/z) of a ToF pixel
//   vertices  as correct_links.frag gives them
#include "common/precision.glsl"
#include "common/constants.glsl"
layout(binding = 0) uniform sampler2D vertices;
layout(binding = 1) uniform sampler2D tof_ray;
uniform mat4 camera_from_tof, clip_from_camera;
uniform vec2 focal_px;
uniform float open_reach_now, shut_reach_now;
// w of the ToF point, negative in cut cells, and z of the homogeneous point in camera axes: both
// are affine over the triangle in space, and their quotient is w in the view.
out vec2 w_and_z;

// Half a step of the ray towards the neighbour in direction d; none where that has no ray.
vec2 half_step(ivec2 at, vec2 ray, ivec2 d) {
  vec2 other = texelFetch(tof_ray, at + d, 0).xy;
  bool is_nan = (floatBitsToInt(other.x) & 0x7fffffff) > 0x7f800000;
  return is_nan ? vec2(0) : 0.5 * (other - ray);
}

// Place in the view, px from its centre.
vec2 place_px(vec2 ray, float w) {
  vec3 q = (camera_from_tof * vec4(ray, 1.0, w)).xyz;
  return q.z > 0.0 ? focal_px * q.xy / q.z : vec2(0.0);
}

// How many half steps a surface reaches past its sample, where what lies beside it is farther.
float reach_past(vec2 ray, vec2 half_step, float w, float other_w) {
  vec2 border = place_px(ray + half_step, w), out_px = border - place_px(ray, w);
  float opens_px = dot(place_px(ray + half_step, other_w) - border, out_px) /
                   max(length(out_px), 1e-6);
  float part = min(1.0, abs(opens_px) / reach_ramp_px);
  return 1.0 + part * ((opens_px > 0.0 ? open_reach_now : shut_reach_now) - 1.0);
}

// Of pixel `at` towards its neighbour in direction d, which may lie outside of the picture.
float reach(ivec2 at, ivec2 d, vec4 vertex, vec2 ray, vec2 half_step) {
  if (d == ivec2(0)) return 0.0;
  ivec2 beside = at + d;
  if (any(lessThan(beside, ivec2(0))) || any(greaterThanEqual(beside, textureSize(vertices, 0))))
    return 1.0;
  vec4 other = texelFetch(vertices, beside, 0);
  int links = int(d.x + d.y > 0 ? vertex.a : other.a), link = d.x != 0 ? 1 : 2;
  if ((links & link) != 0 || other.x >= vertex.x) return 1.0;
  return reach_past(ray, half_step, vertex.x, other.x);
}

void main() {
  ivec2 size = textureSize(vertices, 0);
  int pixels = size.x * size.y;
  int id = gl_VertexID < pixels ? gl_VertexID : (gl_VertexID - pixels) / 9;
  ivec2 at = ivec2(id % size.x, id / size.x);
  vec4 vertex = texelFetch(vertices, at, 0);
  vec2 ray = texelFetch(tof_ray, at, 0).xy;
  float w = vertex.x;
  if (gl_VertexID >= pixels) {
    int corner = (gl_VertexID - pixels) % 9;
    ivec2 to = ivec2(corner % 3 - 1, corner / 3 - 1);
    vec2 step_x = to.x == 0 ? vec2(0) : half_step(at, ray, ivec2(to.x, 0));
    vec2 step_y = to.y == 0 ? vec2(0) : half_step(at, ray, ivec2(0, to.y));
    vec2 far = vec2(reach(at, ivec2(to.x, 0), vertex, ray, step_x),
                    reach(at, ivec2(0, to.y), vertex, ray, step_y));
    ray += far.x * step_x + far.y * step_y;
    w = max(w + 0.5 * dot(vertex.yz, far * vec2(to)), least_corner_part * w);
  }
  vec4 point = camera_from_tof * vec4(ray, 1.0, w);
  w_and_z = vec2(gl_VertexID < pixels ? w : -w, point.z);
  gl_Position = clip_from_camera * point;
}
