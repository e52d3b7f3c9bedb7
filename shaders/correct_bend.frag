#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass correct, third step: distance of a pixel from the line through its neighbours, on the
// straightest axis. Noise bends all axes, an edge of the scene not the one along itself.
//   raw_z_m  metres, 0 unknown
//   bend_m   metres
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/tof.glsl"
layout(binding = 0) uniform sampler2D raw_z_m;
out float bend_m;

void main() {
  const float none = 1e30;
  ivec2 at = ivec2(gl_FragCoord.xy);
  float z = value_at(raw_z_m, at), least = none;
  for (int i = 0; i < 4; ++i) {
    float before = value_at(raw_z_m, at - axes[i]), after = value_at(raw_z_m, at + axes[i]);
    if (min(z, min(before, after)) > 0.0) least = min(least, abs(before - 2.0 * z + after));
  }
  bend_m = least < none ? least : 0.0;
}
