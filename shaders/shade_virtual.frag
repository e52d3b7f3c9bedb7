#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light: shades a pixel's virtual samples under the lamps of the real scene: those of the
// nearest surface together, and those of other surfaces together.
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
uniform bool glossy, emits;  // whether these two textures are there
uniform bool has_people;  // people cast shadows
uniform ivec2 origin_px, size_px;
uniform float exposure;
layout(location = 0) out vec4 color;
layout(location = 1) out float w;

// Sums over some samples of a pixel, except `w`, which is that of the nearest one.
struct Samples {
  vec4 albedo;
  vec3 normal, gloss, emission;
  float w;
};

struct Nearest {
  vec3 normal;
  float depth;
};

vec3 normal_at(ivec2 at) { return 2.0 * texelFetch(normals, at, 0).xyz - 1.0; }

ivec2 sample_of(ivec2 at, int i) {
  return at - origin_px + size_px * ivec2(i % virtual_samples, i / virtual_samples);
}

Nearest nearest_sample(ivec2 at) {
  Nearest nearest = Nearest(vec3(0), 0.0);
  for (int i = 0; i < virtual_samples * virtual_samples; ++i) {
    float d = texelFetch(depth, sample_of(at, i), 0).r;
    if (d > nearest.depth) nearest = Nearest(normal_at(sample_of(at, i)), d);
  }
  return nearest;
}

// Collects the samples of the nearest surface, or the other ones.
Samples samples_of(ivec2 at, Nearest nearest, bool of_nearest) {
  Samples sum = Samples(vec4(0), vec3(0), vec3(0), vec3(0), 0.0);
  for (int i = 0; i < virtual_samples * virtual_samples; ++i) {
    ivec2 from = sample_of(at, i);
    vec4 a = texelFetch(albedo, from, 0);
    float d = texelFetch(depth, from, 0).r;
    vec3 n = normal_at(from);
    bool is_near = dot(n, nearest.normal) >= one_surface_cosine * length(n) * length(nearest.normal);
    if ((d == nearest.depth || (is_near && d >= one_surface_part * nearest.depth)) != of_nearest)
      continue;
    sum.albedo += a;
    sum.normal += a.a * n;
    if (glossy) sum.gloss += a.a * texelFetch(glosses, from, 0).xyz;
    if (emits) sum.emission += texelFetch(emission, from, 0).rgb;
    sum.w = max(sum.w, d / nearest_m);
  }
  return sum;
}

// Light that samples send to the camera, not exposed.
vec3 light_of(ivec2 at, Samples sum) {
  const float share = 1.0 / float(virtual_samples * virtual_samples);
  vec3 position_m = ray_of(at) / sum.w, normal = normalize(sum.normal - vec3(0, 0, 1e-6));
  Surface surface =
      surface_of(share * sum.albedo.rgb, share * sum.albedo.a, sum.gloss / sum.albedo.a);
  vec3 light = glossy ? of_ambient(position_m, normal, surface)
                      : surface.base * diffuse_ambient(normal);
  if (contact_count > 0) {
    Contact contact = contact_at(position_m, normal, 1.0);
    light = contact.open * light + (1.0 - surface.metallic) * surface.base * contact.sent;
  }
  light += share * sum.emission;
  int past_of = -1;
  float past = 1.0;
  for (int i = 0; i < lamp_count; ++i) {
    int whole = lamps[i].map_size_texel.z;
    float seen = 1.0;
    // Past people, once for the parts of a lamp, then past the objects.
    for (int k = has_people && whole != past_of ? 0 : 1; k < 2; ++k) {
      bool past_people = k == 0;
      seen = visibility(past_people ? whole : i, past_people, position_m, normal);
      if (past_people) past = seen;
    }
    past_of = whole;
    seen *= past * seen_in_room(i, position_m, normal);
    vec3 given = irradiance(i, position_m, normal) * seen;
    if (given == vec3(0)) continue;
    light += glossy ? of_lamp(i, position_m, normal, surface, given) : surface.base * given;
  }
  return light;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  Nearest nearest = nearest_sample(at);
  if (nearest.depth == 0.0) discard;
  color = vec4(0);
  // A loop keeps one copy of light_of() in the program.
  for (int k = 0; k < 2; ++k) {
    Samples sum = samples_of(at, nearest, k == 0);
    if (sum.albedo.a == 0.0) continue;
    color += vec4(min(exposure * light_of(at, sum), 1.0),
                  sum.albedo.a / float(virtual_samples * virtual_samples));
  }
  color.rgb = min(color.rgb, 1.0);
  w = nearest.depth / nearest_m;
}
