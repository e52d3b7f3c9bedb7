#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass correct, sixth step: links neighbours on one surface, and finds the slope of that surface.
//   z_m     metres, smoothed, 0 unknown; step_m of correct_clean.frag
//   vertex  w = 1/z (0 unknown), change of w a pixel along x and y, links (1 right, 2 down,
//           4 down-right, 8 down-left) as a number
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/tof.glsl"
layout(binding = 0) uniform sampler2D z_m;
layout(binding = 1) uniform sampler2D step_m;
out vec4 vertex;

bool linked(ivec2 at, ivec2 d) {
  float a = value_at(z_m, at), b = value_at(z_m, at + d);
  if (min(a, b) <= 0.0) return false;
  float limit = min(value_at(step_m, at), value_at(step_m, at + d));
  return abs(a - b) <= limit || (run_on(value_at(z_m, at - d), a, b, limit) &&
                                 run_on(a, b, value_at(z_m, at + 2 * d), limit));
}

// Mean difference of w over the links that hold before and after a pixel; 0 without links.
float slope(ivec2 at, ivec2 d, bool after_holds) {
  bool before_holds = linked(at - d, d);
  float w = 1.0 / value_at(z_m, at);
  float before = before_holds ? w - 1.0 / value_at(z_m, at - d) : 0.0;
  float after = after_holds ? 1.0 / value_at(z_m, at + d) - w : 0.0;
  return (before + after) * (before_holds && after_holds ? 0.5 : 1.0);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float z = value_at(z_m, at);
  vertex = vec4(0.0);
  if (z <= 0.0) return;
  bool right = linked(at, ivec2(1, 0)), down = linked(at, ivec2(0, 1));
  int links = (right ? 1 : 0) + (down ? 2 : 0) + (linked(at, ivec2(1, 1)) ? 4 : 0) +
              (linked(at, ivec2(-1, 1)) ? 8 : 0);
  vertex = vec4(1.0 / z, slope(at, ivec2(1, 0), right), slope(at, ivec2(0, 1), down), links);
}
