#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass virtual: albedo and normal of the nearest virtual surface, four samples a pixel.
//   texture_srgb  sRGB bytes, decoded before the filter, repeating
//   albedo        linear, opaque (the target encodes to sRGB); what is not drawn stays 0
//   normal        camera axes, 0..1 for -1..1
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D texture_srgb;
uniform vec3 base_color;
uniform bool double_sided;
in vec3 camera_normal, camera_position_m;
in vec2 mesh_uv;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normal;

void main() {
  vec3 n = normalize(camera_normal);
  if (double_sided && dot(n, camera_position_m) > 0.0) n = -n;
  albedo = vec4(base_color * texture(texture_srgb, mesh_uv).rgb, 1.0);
  normal = vec4(0.5 * n + 0.5, 1.0);
}
