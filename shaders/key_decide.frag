#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key: depth and colour vote together, drawn only for blocks where votes decide.
//   state         of key_state.frag
//   counts        blocks without speckles (common/key.glsl)
//   band          from key_band.frag
//   votes         from key_votes.frag, blocks with a border of one
//   matte         people, 0..1, not yet refined (key_matte.frag)
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
layout(binding = 0) uniform sampler2D state;
layout(binding = 1) uniform sampler2D counts;
layout(binding = 2) uniform sampler2D band;
layout(binding = 3) uniform sampler2D votes;
uniform bool use_color, is_still;
uniform ivec2 tap_px;  // half a footprint and a whole one
out float matte;

int state_at(ivec2 at) {
  at = clamp(at, ivec2(0), textureSize(state, 0) - 1);
  int s = to_state(texelFetch(state, at, 0).r);
  if (s != foreground && s != unknown) return s;
  int flag = s == foreground ? 4 : by_mirror_flag();
  bool dropped = (int(texelFetch(counts, at / block_px, 0).w) & flag) != 0;
  return dropped ? background : s;
}

int tap(int i) { return i == 0 ? 0 : sign(i) * (abs(i) == 1 ? tap_px.x : tap_px.y); }

float share_at(ivec2 at) {
  int s = state_at(at);
  return s == foreground ? 1.0 : s == background ? 0.0 : unknown_share;
}

float depth_vote(ivec2 at) {
  float sum = 0.0;
  for (int j = -depth_tap_radius; j <= depth_tap_radius; ++j)
    for (int i = -depth_tap_radius; i <= depth_tap_radius; ++i)
      sum += share_at(at + ivec2(tap(i), tap(j)));
  const int taps = 2 * depth_tap_radius + 1;
  float balance = 2.0 * sum / float(taps * taps) - 1.0;
  return (balance > 0.0 ? foreground_weight : background_weight) * balance;
}

// Weighted mean over 3x3 pixels.
float color_vote(ivec2 at, ivec2 block) {
  if (!use_color) return 0.0;
  ivec2 first = at + 2 * block;  // block * (block_px + 2) + at - block * block_px, less the border
  float side = is_still ? vote_side : 1.0, sum = 0.0;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      sum += (i == 1 ? 1.0 : side) * (j == 1 ? 1.0 : side) * texelFetch(votes, first + ivec2(i, j), 0).r;
  return sum / ((1.0 + 2.0 * side) * (1.0 + 2.0 * side));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), block = at / block_px;
  vec4 near = texelFetch(band, block, 0);
  int flags = int(near.x);
  int s = state_at(at);
  matte = s == foreground ? 1.0 : 0.0;
  if ((flags & 2) != 0 || s == doubt || ((flags & 1) != 0 && s == unknown))
    matte = clamp(0.5 + 0.5 * (color_vote(at, block) + depth_vote(at)), 0.0, 1.0);
}
