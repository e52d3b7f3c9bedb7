#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass agree: compares the depths of a camera with those of another one. A surface that the other
// camera measures too gets the weighted mean of both depths; one that it sees through becomes
// unknown; the rest stays.
//   z_m, step_m, tof_ray  of this camera (correct_smooth.frag, correct_clean.frag)
//   other_z_m, other_step_m  of the other camera
//   other_px  the other camera's pixel for each pixel of its picture without lens; NaN: none
//   agreed_m  metres, 0 unknown
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/tof.glsl"
layout(binding = 0) uniform sampler2D z_m;
layout(binding = 1) uniform sampler2D step_m;
layout(binding = 2) uniform sampler2D tof_ray;
layout(binding = 3) uniform sampler2D other_z_m;
layout(binding = 4) uniform sampler2D other_step_m;
layout(binding = 5) uniform sampler2D other_px;
uniform mat4 other_from_tof;
uniform vec2 focal_px, center_px;
uniform float px_per_px;
uniform vec3 noise, other_noise;  // floor_m, linear, quadratic_per_m
out float agreed_m;

float sigma_m(vec3 n, float z) { return n.x + z * (n.y + z * n.z); }

// Whether all 4x4 pixels around are known and beyond a limit.
bool looks_through(ivec2 corner, float limit_m) {
  float nearest = value_at(other_z_m, corner);
  for (int j = -1; j <= 2; ++j)
    for (int i = -1; i <= 2; ++i)
      nearest = min(nearest, value_at(other_z_m, corner + ivec2(i, j)));
  return nearest > limit_m;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float z = value_at(z_m, at);
  agreed_m = z;
  if (z <= 0.0) return;
  vec3 p = (other_from_tof * vec4(texelFetch(tof_ray, at, 0).xy * z, z, 1.0)).xyz;
  if (p.z <= nearest_m) return;
  vec2 uv = focal_px * p.xy / p.z + center_px;
  ivec2 size = textureSize(other_px, 0);
  vec2 last = vec2(size - 1);
  if (any(lessThan(uv, vec2(0))) || any(greaterThan(uv, last))) return;
  ivec2 near_uv = ivec2(uv + 0.5);
  vec2 px = texelFetch(other_px, near_uv, 0).xy;
  if ((floatBitsToInt(px.x) & 0x7fffffff) > 0x7f800000) return;
  px += (uv - vec2(near_uv)) * px_per_px;
  if (any(lessThan(px, vec2(0))) || any(greaterThanEqual(px, last))) return;
  ivec2 corner = ivec2(px);
  float a = value_at(other_z_m, corner), b = value_at(other_z_m, corner + ivec2(1, 0));
  float c = value_at(other_z_m, corner + ivec2(0, 1)), d = value_at(other_z_m, corner + ivec2(1));
  float nearest = min(min(a, b), min(c, d)), farthest = max(max(a, b), max(c, d));
  if (nearest <= 0.0) return;
  float limit_m = max(value_at(step_m, at), value_at(other_step_m, corner));
  if (p.z < nearest - limit_m) {
    if (looks_through(corner, p.z + limit_m)) agreed_m = 0.0;
    return;
  }
  if (farthest - nearest > limit_m) return;
  vec2 part = px - vec2(corner);
  float measured_m = mix(mix(a, b, part.x), mix(c, d, part.x), part.y);
  float off_m = measured_m - p.z;
  if (abs(off_m) > limit_m) return;
  float own = pow(sigma_m(noise, z), 2.0), other = pow(sigma_m(other_noise, measured_m), 2.0);
  agreed_m = z + off_m * (own + other > 0.0 ? own / (own + other) : 0.5);
}
