#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light: the mean of a pixel's virtual samples, under the same lamps as the real scene.
//   albedo  linear, alpha 1 where covered; normal 0..1 for -1..1; depth nearest_m / z: a picture of
//           size_px from origin_px on for each sample, virtual_samples along each axis
//   color   linear, premultiplied by the coverage in alpha
//   w       1/m, of the nearest sample
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/color.glsl"
#include "common/view.glsl"
#include "common/contact.glsl"
#include "common/lamps.glsl"
#include "common/gloss.glsl"
layout(binding = 0) uniform sampler2D albedo;
layout(binding = 1) uniform sampler2D normals;
layout(binding = 2) uniform sampler2D depth;
layout(binding = 3) uniform sampler2D glosses;   // metallic, roughness, specular
layout(binding = 4) uniform sampler2D emission;  // linear
uniform bool glossy, emits;  // whether there are these two
layout(std140, binding = 1) uniform PeopleLamps { Lamp people_lamps[most_lamps]; };
layout(binding = 6) uniform sampler2DArray people_maps;
uniform bool has_people;  // they cast shadows
uniform ivec2 origin_px, size_px;
uniform float exposure;
layout(location = 0) out vec4 color;
layout(location = 1) out float w;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 sum = vec4(0);
  vec3 normal = vec3(0), gloss = vec3(0), own = vec3(0);
  float nearest = 0.0;
  for (int j = 0; j < virtual_samples; ++j)
    for (int i = 0; i < virtual_samples; ++i) {
      ivec2 sample_at = at - origin_px + size_px * ivec2(i, j);
      vec4 a = texelFetch(albedo, sample_at, 0);
      sum += a;
      normal += a.a * (2.0 * texelFetch(normals, sample_at, 0).xyz - 1.0);
      if (glossy) gloss += a.a * texelFetch(glosses, sample_at, 0).xyz;
      if (emits) own += texelFetch(emission, sample_at, 0).rgb;
      nearest = max(nearest, texelFetch(depth, sample_at, 0).r);
    }
  if (sum.a == 0.0) discard;
  w = nearest / nearest_m;
  vec3 ray = ray_of(at);
  normal = normalize(normal - vec3(0, 0, 1e-6));
  gloss /= sum.a;
  Lobe lobe = lobe_of(ray / w, normal, gloss.y);
  Shading light = Shading(diffuse_ambient(normal), vec3(0), vec3(0), vec3(0));
  if (glossy) add_ambient_gloss(lobe, light);
  int past_of = -1;
  float past = 1.0;
  if (contact_count > 0) {
    Contact contact = contact_at(ray / w, normal, 1.0);
    light.diffuse = contact.open * light.diffuse + contact.sent;
    light.straight *= contact.open, light.grazing *= contact.open, light.lost *= contact.open;
  }
  for (int i = 0; i < lamp_count; ++i) {
    float seen = visibility(i, ray / w, normal);
    int whole = lamps[i].map_size_texel.z;
    if (has_people && whole != past_of)
      past = visibility_past(people_lamps[whole], people_maps, whole, ray / w, normal);
    past_of = whole;
    seen *= past * seen_in_room(i, ray / w, normal);
    vec3 of_lamp = irradiance(i, ray / w, normal) * seen;
    light.diffuse += of_lamp;
    if (glossy && of_lamp != vec3(0)) add_lamp_gloss(i, ray / w, lobe, of_lamp, light);
  }
  const float share = 1.0 / float(virtual_samples * virtual_samples);
  sum *= share;
  vec3 lit = glossy ? shown(sum.rgb, sum.a, gloss, light) : sum.rgb * light.diffuse;
  color = vec4(min((lit + share * own) * exposure, 1.0), sum.a);
}
