#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, by colour: log odds of foreground. The target holds each block's pixels with a border
// of one, since neighbouring blocks compare with other people.
//   plate         linear light, view
//   learned       background colour, linear, red negative where unknown, and its sigma (0 where
//                 not learned)
//   band, person, room, person_deep  blocks, of key_band.frag
//   vote          within color_vote_cap, or up to brighter_vote_cap; drawn only where votes decide;
//                 also whether people's colours cannot explain the pixel (common/key.glsl)
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
#include "common/color.glsl"
#include "common/tone.glsl"
layout(binding = 0) uniform sampler2D plate;
layout(binding = 1) uniform sampler2D learned;
layout(binding = 2) uniform sampler2D learned_sigma;
layout(binding = 3) uniform sampler2D band;
layout(binding = 4) uniform sampler2D person;
layout(binding = 5) uniform sampler2D room;
layout(binding = 7) uniform sampler2D person_deep;  // unit 6 is that of blocks.vert
uniform bool has_learned, has_sigma, is_still;
out float vote;

// Log odds of a colour by a mean and its variance, without constants.
float odds_of(vec3 p, vec4 color) {
  vec3 off = p - color.rgb;
  return -0.5 * dot(off, off) / color.a - spread_odds * log(color.a);
}

void main() {
  ivec2 tile = ivec2(gl_FragCoord.xy), block = tile / (block_px + 2);
  vec4 near = texelFetch(band, block, 0);
  int flags = int(near.x);
  ivec2 at = block * block_px + tile - block * (block_px + 2) - 1;
  at = clamp(at, ivec2(0), textureSize(plate, 0) - 1);
  vec3 p = texelFetch(plate, at, 0).rgb;
  bool has_mean = (flags & 8) != 0;
  vec4 deep = texelFetch(person_deep, block, 0);
  bool has_deep = has_learned && deep.a > 0.0, has_person = has_mean || has_deep;
  vec4 around = texelFetch(room, block, 0);
  vote = 0.0;
  if (!has_learned && (around.a == 0.0 || !has_person)) return;
  vec3 off = p - around.rgb;
  float background2 = dot(off, off) / max(around.a, 1e-12), variance = around.a;
  bool no_shadow = false;  // the colour is no shadow of people on the learned background
  if (has_learned) {
    vec3 known = texelFetch(learned, at, 0).rgb;
    if (known.r < 0.0) return;  // unknown
    vec3 b = min(shown_now(known), 1.0);
    float spread = has_sigma ? gain.g * texelFetch(learned_sigma, at, 0).r : 0.0;
    variance = spread * spread + floor_variance(b);
    // A shadow darkens the background without changing its hue.
    float shade = dot(p, b) / max(dot(b, b), 1e-8), k = clamp(shade, darkest_shadow, 1.0);
    off = p - k * b;
    float dark = (1.0 - k) / shadow_sigma;
    background2 = dot(off, off) / variance + dark * dark;
    vec3 other = p - clamp(shade, deepest_shadow, 1.0) * b;
    bool is_brighter = luminance(p) > brighter * luminance(b) + brighter_light;
    bool is_other = is_still && dot(other, other) > other_color * variance;
    no_shadow = has_person && (is_brighter || is_other);
  }
  float odds = 0.5 * background2 - color_vote_cap;
  if (has_person) {
    float person_odds = has_mean ? odds_of(p, vec4(texelFetch(person, block, 0).rgb, near.z)) : -1e9;
    if (has_deep) person_odds = max(person_odds, odds_of(p, deep));
    odds = 0.5 * background2 + spread_odds * log(variance) + person_odds;
  }
  float cap = has_learned ? color_vote_cap : room_vote_cap;
  vote = stored_vote(clamp(odds, -cap, no_shadow ? brighter_vote_cap : cap),
                     has_learned && has_person && odds < inside_odds);
}
