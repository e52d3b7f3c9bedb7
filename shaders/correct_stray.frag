#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass correct, second step: small pieces of depth far in front of all that is around them become
// unknown. A ToF camera puts pixels that saw two surfaces a period of its modulation too near.
//   z_m      metres, 0 unknown
//   raw_z_m  the same without stray pieces
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/tof.glsl"
layout(binding = 0) uniform sampler2D z_m;
uniform float stray_px_m2;
out float raw_z_m;

// The window around a pixel, a bit a pixel: a piece that reaches its outermost rows or columns is
// none. One more on each side than a piece may have.
const int middle = stray_reach_px + 1;
const int window = 2 * middle + 1;
const uint outermost = 1u | 1u << (window - 1);

bool is_near(ivec2 at, float limit) {
  float z = texelFetch(z_m, at, 0).r;
  return z > 0.0 && z <= limit;
}

// Whether two opposite pixels at the reach are both near.
bool runs_through(ivec2 at, float limit) {
  for (int i = 0; i < 4; ++i)
    if (is_near(at + stray_reach_px * axes[i], limit) &&
        is_near(at - stray_reach_px * axes[i], limit))
      return true;
  return false;
}

// Pixels that are connected with the middle one; all of the window's where they reach its border.
int piece_px(ivec2 at, float limit) {
  uint near[window], piece[window];
  for (int j = 0; j < window; ++j) {
    near[j] = 0u;
    piece[j] = 0u;
    for (int i = 0; i < window; ++i)
      if (is_near(at + ivec2(i, j) - middle, limit)) near[j] |= 1u << i;
  }
  piece[middle] = 1u << middle;
  for (bool grows = true; grows;) {
    grows = false;
    for (int j = 1; j < window - 1; ++j) {
      uint rows = piece[j - 1] | piece[j] | piece[j + 1];
      uint joined = near[j] & (rows | rows << 1 | rows >> 1);
      grows = grows || joined != piece[j];
      piece[j] = joined;
      if ((joined & outermost) != 0u) return window * window;
    }
    if ((piece[1] | piece[window - 2]) != 0u) return window * window;
  }
  int count = 0;
  for (int j = 0; j < window; ++j) count += bitCount(piece[j]);
  return count;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(z_m, 0);
  raw_z_m = texelFetch(z_m, at, 0).r;
  bool fits = all(greaterThanEqual(at, ivec2(middle))) && all(lessThan(at, size - middle));
  if (stray_px_m2 <= 0.0 || raw_z_m <= 0.0 || !fits) return;
  float limit = stray_gap * raw_z_m;
  if (runs_through(at, limit)) return;
  if (float(piece_px(at, limit)) * raw_z_m * raw_z_m <= stray_px_m2) raw_z_m = 0.0;
}
