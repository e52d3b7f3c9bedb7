#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass warp: inverse depth of the nearest ToF surface in the view (selected by the depth test).
//   w  1/m, negative where a cut cell drew it, 0 unknown
#include "common/precision.glsl"
in vec2 w_and_z;
out float w;
void main() { w = w_and_z.x / w_and_z.y; }
