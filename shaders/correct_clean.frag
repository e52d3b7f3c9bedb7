#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass correct, fourth step: finds the threshold of a depth step, and gives flying pixels to a
// surface.
//   raw_z_m  metres, 0 unknown; bend_m of correct_bend.frag
//   z_m      metres, 0 unknown
//   step_m   threshold of a depth step at the pixel
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/tof.glsl"
layout(binding = 0) uniform sampler2D raw_z_m;
layout(binding = 1) uniform sampler2D bend_m;
uniform float noise_floor_m, noise_linear, noise_quadratic_per_m;
uniform float step_sigmas, step_min_m, step_bends, bends_part;
layout(location = 0) out float z_m;
layout(location = 1) out float step_m;

float find_step(ivec2 at, float z) {
  float sigma_m = noise_floor_m + z * (noise_linear + z * noise_quadratic_per_m), sum = 0.0;
  for (int i = 0; i < 9; ++i) sum += value_at(bend_m, at + ivec2(i % 3 - 1, i / 3 - 1));
  float by_noise = min(steepest * z, step_sigmas * sqrt(2.0) * sigma_m);
  return max(step_min_m, max(by_noise, min(bends_part * z, step_bends / 9.0 * sum)));
}

// near, far: depths one and two pixels away on either side. Amplitudes fall with the square of the
// distance, so the near surface counts more.
float owner_z(float z, vec2 near, vec2 far) {
  float z_near = near.y > 0.0 ? min(near.x, near.y) : near.x;
  float z_far = max(far.x, far.y);
  float share = (z_far - z) / (z_far - z_near);
  return share * z_near * z_near >= (1.0 - share) * z_far * z_far ? z_near : z_far;
}

// Element n / 2 of the n known neighbours in ascending order; 0 for fewer than least_known.
float median(float around[8], int known) {
  if (known < least_known) return 0.0;
  for (int i = 0; i < 8; ++i) {
    int below = 0;
    for (int k = 0; k < 8; ++k)
      if (around[k] > 0.0 && (around[k] < around[i] || (around[k] == around[i] && k < i))) ++below;
    if (around[i] > 0.0 && below == known / 2) return around[i];
  }
  return 0.0;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float z = value_at(raw_z_m, at), around[8];
  int known = 0, supporters = 0;
  step_m = find_step(at, z);
  for (int i = 0; i < 4; ++i) {
    vec2 before = vec2(value_at(raw_z_m, at - axes[i]), value_at(raw_z_m, at - 2 * axes[i]));
    vec2 after = vec2(value_at(raw_z_m, at + axes[i]), value_at(raw_z_m, at + 2 * axes[i]));
    bool has_before = before.x > 0.0, has_after = after.x > 0.0;
    bool near_before = abs(before.x - z) <= step_m, near_after = abs(after.x - z) <= step_m;
    bool runs = run_on(z, before.x, before.y, step_m) || run_on(z, after.x, after.y, step_m);
    bool between = z > 0.0 && has_before && has_after && (before.x - z) * (after.x - z) < 0.0;
    if (between && !near_before && !near_after && !runs) {
      z_m = before.x < after.x ? owner_z(z, before, after) : owner_z(z, after, before);
      return;
    }
    known += (has_before ? 1 : 0) + (has_after ? 1 : 0);
    supporters += (has_before && near_before ? 1 : 0) + (has_after && near_after ? 1 : 0);
    if (runs) supporters = least_supporters;
    around[2 * i] = before.x;
    around[2 * i + 1] = after.x;
  }
  z_m = z > 0.0 && supporters >= least_supporters ? z : median(around, known);
}
