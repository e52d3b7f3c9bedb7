#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass shadow: writes only depth (gl_convention.h: near / z), inside a disc.
#include "common/precision.glsl"
void main() {
  vec2 from_center = 2.0 * gl_PointCoord - 1.0;
  if (dot(from_center, from_center) > 1.0) discard;
}
