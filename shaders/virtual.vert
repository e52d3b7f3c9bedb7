#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass virtual: transforms a mesh's vertex into the picture of one of a pixel's samples.
//   position_m, normal  object axes; uv of the texture, v down
#include "common/precision.glsl"
layout(location = 0) in vec3 position_m;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
uniform mat4 camera_from_object, clip_from_camera;
uniform mat3 camera_from_object_normal;
out vec3 camera_normal, camera_position_m;
out vec2 mesh_uv;

void main() {
  vec4 point = camera_from_object * vec4(position_m, 1.0);
  camera_position_m = point.xyz;
  camera_normal = camera_from_object_normal * normal;
  mesh_uv = uv;
  gl_Position = clip_from_camera * point;
}
