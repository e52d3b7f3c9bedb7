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
// w of the ToF point, negative in cut cells, and z of the homogeneous point in camera axes: both
// are affine over the triangle in space, and their quotient is w in the view.
out vec2 w_and_z;

// Half a step of the ray towards the neighbour in direction d; none where that has no ray.
vec2 half_step(ivec2 at, vec2 ray, ivec2 d) {
  vec2 other = texelFetch(tof_ray, at + d, 0).xy;
  bool is_nan = (floatBitsToInt(other.x) & 0x7fffffff) > 0x7f800000;
  return is_nan ? vec2(0) : 0.5 * (other - ray);
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
    ray += step_x + step_y;
    w = max(w + 0.5 * dot(vertex.yz, vec2(to)), least_corner_part * w);
  }
  vec4 point = camera_from_tof * vec4(ray, 1.0, w);
  w_and_z = vec2(gl_VertexID < pixels ? w : -w, point.z);
  gl_Position = clip_from_camera * point;
}
