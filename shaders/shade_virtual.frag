#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light: the mean of a pixel's virtual samples, under the same lamps as the real scene.
//   albedo  linear, alpha 1 where covered; normal 0..1 for -1..1; depth nearest_m / z: samples,
//           virtual_samples a pixel along each axis, from origin_px
//   color   linear, premultiplied by the coverage in alpha
//   w       1/m, of the nearest sample
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/color.glsl"
#include "common/view.glsl"
#include "common/lamps.glsl"
layout(binding = 0) uniform sampler2D albedo;
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D depth;
layout(std140, binding = 1) uniform PeopleLamps { Lamp people_lamps[most_lamps]; };
layout(binding = 6) uniform sampler2DArray people_maps;
uniform bool has_people;  // they cast shadows
uniform ivec2 origin_px;
uniform float exposure;
layout(location = 0) out vec4 color;
layout(location = 1) out float w;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 sum = vec4(0);
  vec3 normal = vec3(0);
  float nearest = 0.0;
  for (int j = 0; j < virtual_samples; ++j)
    for (int i = 0; i < virtual_samples; ++i) {
      ivec2 sample_at = virtual_samples * (at - origin_px) + ivec2(i, j);
      vec4 a = texelFetch(albedo, sample_at, 0);
      sum += a;
      normal += a.a * (2.0 * texelFetch(normals, sample_at, 0).xyz - 1.0);
      nearest = max(nearest, texelFetch(depth, sample_at, 0).r);
    }
  if (sum.a == 0.0) discard;
  w = nearest / nearest_m;
  vec3 ray = ray_of(at);
  normal = normalize(normal - vec3(0, 0, 1e-6));
  vec3 light = ambient;
  for (int i = 0; i < lamp_count; ++i) {
    float seen = visibility(i, ray / w, normal);
    if (has_people)
      seen *= visibility_past(people_lamps[i], people_maps, i, ray / w, normal);
    light += irradiance(i, ray / w, normal) * seen * seen_in_room(i, ray / w, normal);
  }
  const float share = 1.0 / float(virtual_samples * virtual_samples);
  color = vec4(min(share * sum.rgb * light * exposure, 1.0), share * sum.a);
}
