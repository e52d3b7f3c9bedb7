#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass correct, fifth step: mean of inverse depth over neighbours within half a step, and over
// pairs of opposite ones within a step: one side alone would bias a sloping surface.
//   clean_z_m, step_m  of correct_clean.frag
//   z_m                metres, 0 unknown
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/tof.glsl"
layout(binding = 0) uniform sampler2D clean_z_m;
layout(binding = 1) uniform sampler2D step_m;
out float z_m;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float z = value_at(clean_z_m, at), step = value_at(step_m, at), count = 1.0;
  z_m = 0.0;
  if (z <= 0.0) return;
  float sum = 1.0 / z;
  for (int i = 0; i < 4; ++i) {
    float before = value_at(clean_z_m, at - axes[i]), after = value_at(clean_z_m, at + axes[i]);
    float off_before = abs(before - z), off_after = abs(after - z);
    float limit = max(off_before, off_after) <= step ? step : smooth_part * step;
    if (before > 0.0 && off_before <= limit) sum += 1.0 / before, count += 1.0;
    if (after > 0.0 && off_after <= limit) sum += 1.0 / after, count += 1.0;
  }
  z_m = count / sum;
}
