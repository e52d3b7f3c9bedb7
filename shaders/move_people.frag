#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Moves people's depth to where they were at the time of the plate, before pass key.
//   w         1/m, sign aside; 0 unknown
//   limit_w   limit of the key, 1/m
//   shift_px  of each cell, whole pixels by which what moves into it is moved
//   moved_w   in the format of w
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D w;
layout(binding = 1) uniform sampler2D limit_w;
layout(binding = 2) uniform sampler2D shift_px;
uniform int cell_px;
out float moved_w;

bool in_front(ivec2 at, float measured) {
  return abs(measured) > abs(texelFetch(limit_w, at, 0).r);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec2 cell = min(at / cell_px, textureSize(shift_px, 0) - 1);
  ivec2 from = clamp(at - ivec2(texelFetch(shift_px, cell, 0).xy), ivec2(0), textureSize(w, 0) - 1);
  moved_w = texelFetch(w, at, 0).r;
  if (from == at) return;
  float there = texelFetch(w, from, 0).r;
  if (in_front(from, there)) moved_w = there;
  else if (in_front(at, moved_w)) moved_w = 0.0;
}
