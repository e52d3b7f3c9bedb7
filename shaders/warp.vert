#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass warp, last step: transforms a vertex of the ToF mesh (ids as in cells.comp) into the view.
// GPUs that draw in tiles run it twice.
//   vertices  from correct_links.frag
//   tof_ray   (x/z, y/z) of a ToF pixel
//   reaches   of warp_reach.frag
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/grid.glsl"
#include "common/mesh.glsl"
layout(binding = 2) uniform sampler2D reaches;
uniform mat4 clip_from_camera;
// w of the ToF point, negative in cut cells, and z of the homogeneous point in camera axes: both
// are affine over the triangle in space, and their quotient is w in the view.
out vec2 w_and_z;

void main() {
  ivec2 size = textureSize(vertices, 0);
  int pixels = size.x * size.y;
  int id = gl_VertexID < pixels ? gl_VertexID : int(uint(gl_VertexID - pixels) / 9u);
  ivec2 at = place_in_grid(id, size.x);
  vec4 vertex = texelFetch(vertices, at, 0);
  vec2 ray = texelFetch(tof_ray, at, 0).xy;
  float w = vertex.x;
  if (gl_VertexID >= pixels) {
    int corner = gl_VertexID - pixels - 9 * id, side = int(corner > 2) + int(corner > 5);
    ivec2 to = ivec2(corner - 3 * side, side) - 1;
    vec4 reach = texelFetch(reaches, at, 0);
    vec2 step_x = to.x == 0 ? vec2(0) : half_step(at, ray, ivec2(to.x, 0));
    vec2 step_y = to.y == 0 ? vec2(0) : half_step(at, ray, ivec2(0, to.y));
    vec2 far = vec2(to.x == 0 ? 0.0 : to.x < 0 ? reach.x : reach.y,
                    to.y == 0 ? 0.0 : to.y < 0 ? reach.z : reach.w);
    ray += far.x * step_x + far.y * step_y;
    w = max(w + 0.5 * dot(vertex.yz, far * vec2(to)), least_corner_part * w);
  }
  vec4 point = camera_from_tof * vec4(ray, 1.0, w);
  w_and_z = vec2(gl_VertexID < pixels ? w : -w, point.z);
  gl_Position = clip_from_camera * point;
}
