#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass virtual: albedo and normal of the nearest virtual surface, at one of a pixel's four samples.
//   texture_srgb  sRGB bytes, decoded before the filter, repeating
//   albedo        linear, opaque (the target encodes to sRGB); what is not drawn stays 0
//   normal        camera axes, 0..1 for -1..1
//   gloss         metallic, roughness, specular; emission linear (encoded as albedo): only if the
//                 target has them
//   The maps are those of MeshView; a missing one is white (the normal map: straight).
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D texture_srgb;
layout(binding = 1) uniform sampler2D gloss_map;
layout(binding = 2) uniform sampler2D normal_map;
layout(binding = 3) uniform sampler2D emission_map;
uniform vec3 base_color, emission_factor, gloss_factor;
uniform bool double_sided, has_normal_map;
uniform float normal_scale;
in vec3 camera_normal, camera_position_m;
in vec2 mesh_uv;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normal;
layout(location = 2) out vec4 gloss;
layout(location = 3) out vec4 emission;

// Normal by the normal map: tangents along u and against v of the triangle.
vec3 bent(vec3 n) {
  vec3 e1 = dFdx(camera_position_m), e2 = dFdy(camera_position_m);
  vec2 d1 = dFdx(mesh_uv), d2 = dFdy(mesh_uv);
  float turn = d1.x * d2.y - d1.y * d2.x < 0.0 ? -1.0 : 1.0;
  vec3 along = turn * (e1 * d2.y - e2 * d1.y), up = turn * (e1 * d2.x - e2 * d1.x);
  vec3 flat_along = along - dot(along, n) * n;
  float size = length(flat_along);
  if (!(size > 0.0)) return n;
  vec3 tangent = flat_along / size, across = cross(n, tangent);
  vec3 bitangent = dot(across, up) < 0.0 ? -across : across;
  vec3 texel = 2.0 * texture(normal_map, mesh_uv).xyz - 1.0;
  return normalize(normal_scale * (texel.x * tangent + texel.y * bitangent) +
                   max(texel.z, 1e-3) * n);
}

void main() {
  vec3 n = normalize(camera_normal);
  if (double_sided && dot(n, camera_position_m) > 0.0) n = -n;
  if (has_normal_map) n = bent(n);
  vec3 map = texture(gloss_map, mesh_uv).rgb;
  gloss = vec4(gloss_factor * vec3(map.b, map.g, 1.0), 1.0);
  emission = vec4(emission_factor * texture(emission_map, mesh_uv).rgb, 1.0);
  albedo = vec4(base_color * texture(texture_srgb, mesh_uv).rgb, 1.0);
  normal = vec4(0.5 * n + 0.5, 1.0);
}
