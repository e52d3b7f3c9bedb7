// SPDX-License-Identifier: Apache-2.0
// Pass correct: functions shared by its steps (docs/method/compositor.md). Depths are z in metres, 0
// unknown. Needs common/constants.glsl.
const ivec2 axes[4] = ivec2[](ivec2(1, 0), ivec2(0, 1), ivec2(1, 1), ivec2(-1, 1));

// A value of the grid; 0 (unknown) outside the picture.
float value_at(sampler2D grid, ivec2 at) {
  ivec2 size = textureSize(grid, 0);
  bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, size));
  return inside ? texelFetch(grid, at, 0).r : 0.0;
}

// Whether three depths in line lie on one plane, to within a part of a step.
bool run_on(float a, float b, float c, float step_m) {
  float z = min(a, min(b, c));
  if (z <= 0.0 || max(a, max(b, c)) > (1.0 + 2.0 * steepest) * z) return false;
  return abs(1.0 / a - 2.0 / b + 1.0 / c) * (z * z) <= plane_part * step_m;
}
