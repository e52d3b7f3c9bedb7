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
uniform bool use_color;
uniform ivec2 tap_px;  // half a footprint and a whole one
uniform int inside_px;  // distance of the taps all around
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

// People's share of the taps around: those of the depth vote or, for `inside`, wider ones.
float share_around(ivec2 at, bool inside) {
  float sum = 0.0;
  for (int j = -depth_tap_radius; j <= depth_tap_radius; ++j)
    for (int i = -depth_tap_radius; i <= depth_tap_radius; ++i)
      sum += share_at(at + (inside ? inside_px * ivec2(i, j) : ivec2(tap(i), tap(j))));
  const int taps = 2 * depth_tap_radius + 1;
  return sum / float(taps * taps);
}

float depth_vote(ivec2 at) {
  float balance = 2.0 * share_around(at, false) - 1.0;
  return (balance > 0.0 ? foreground_weight : background_weight) * balance;
}

// Means over 3x3 pixels: the vote, and the part that people's colours cannot explain.
vec2 color_vote(ivec2 at, ivec2 block) {
  if (!use_color) return vec2(0);
  ivec2 first = at + 2 * block;  // block * (block_px + 2) + at - block * block_px, less the border
  vec2 sum = vec2(0);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) sum += vote_and_other(texelFetch(votes, first + ivec2(i, j), 0).r);
  return sum / 9.0;
}

float odds_of_people(ivec2 at, ivec2 block, int s) {
  vec2 color = color_vote(at, block);
  // 1e-4: the cpu back end sums fifths exactly.
  bool inside = s == foreground && color.y < 0.5 && share_around(at, true) >= inside_share - 1e-4;
  return color.x + (inside ? inside_weight : depth_vote(at));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), block = at / block_px;
  vec4 near = texelFetch(band, block, 0);
  int flags = int(near.x);
  int s = state_at(at);
  matte = s == foreground ? 1.0 : 0.0;
  if ((flags & 2) != 0 || s == doubt || ((flags & 1) != 0 && s == unknown))
    matte = clamp(0.5 + 0.5 * odds_of_people(at, block, s), 0.0, 1.0);
}
