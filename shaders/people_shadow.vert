#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass shadow: draws a disc for each ball of a person into a lamp's map.
//   balls  of people_balls.frag, one vertex each
#include "common/precision.glsl"
#include "common/grid.glsl"
layout(binding = 0) uniform sampler2D balls;
uniform mat4 lamp_from_camera, clip_from_lamp;
uniform float focal_texel, near_m;

void main() {
  int width = textureSize(balls, 0).x;
  vec4 ball = texelFetch(balls, place_in_grid(gl_VertexID, width), 0);
  vec4 p = lamp_from_camera * vec4(ball.xyz, 1.0);
  bool drawn = ball.w > 0.0 && p.z > near_m;
  gl_Position = drawn ? clip_from_lamp * p : vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = drawn ? 2.0 * ball.w * focal_texel / p.z : 1.0;
}
