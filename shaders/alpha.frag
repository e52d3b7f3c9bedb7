#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass mix: share of a pixel that shows anything, where nothing replaces the background.
//   matte          people, 0..1
//   virtual_color  coverage in alpha
//   alpha          0..1
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D matte;
layout(binding = 1) uniform sampler2D virtual_color;
uniform bool has_objects;
out float alpha;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float covered = has_objects ? texelFetch(virtual_color, at, 0).a : 0.0;
  alpha = 1.0 - (1.0 - texelFetch(matte, at, 0).r) * (1.0 - covered);
}
