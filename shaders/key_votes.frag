#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, by colour: log odds of foreground. The target holds each block's pixels with a border
// of one, since neighbouring blocks compare with other people.
//   plate         linear light, view
//   learned       background colour, linear, red negative where unknown, and its sigma (0 where
//                 not learned)
//   band, person, room, person_deep  blocks, of key_band.frag
//   light  of key_light.frag, for a still camera: the room's light around and its variation
//   vote          within color_vote_cap, or up to other_vote_cap; drawn only where votes decide
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
layout(binding = 8) uniform sampler2D light;
uniform bool has_learned, has_sigma, is_still;  // is_still: with a learned colour
out float vote;

// Log odds of a colour of people, without constants: distances are those of the covariance
// v*I + s^2*m*m^T of variance v, mean m and s = people_shade (Sherman and Morrison), its
// determinant that of v*I. Light flickers on people as on the room beside them: a person in the
// room's colour is as likely as the room.
float odds_of(vec3 p, vec4 color, float flicker) {
  vec3 off = p - color.rgb;
  float variance = color.a - floor_variance(color.rgb, color_flicker) +
                   floor_variance(color.rgb, min(flicker, color_flicker));
  float by_light = people_shade * dot(off, color.rgb);
  float along = variance + people_shade * people_shade * dot(color.rgb, color.rgb);
  return -0.5 * (dot(off, off) - by_light * by_light / along) / variance - spread_odds * log(variance);
}

// Squared distance of a colour to the room's light now, over its variance, that variance, and
// whether the colour is no shadow of people on the room.
struct Room {
  float square, variance;
  bool no_shadow;
};

// darkest: what is darker than this factor of b is no shadow.
Room to_room(vec3 p, vec3 b, float spread, float flicker, float darkest) {
  float variance = spread * spread + floor_variance(b, flicker);
  // A shadow darkens the background without changing its hue.
  float shade = dot(p, b) / max(dot(b, b), 1e-8), k = clamp(shade, darkest_shadow, 1.0);
  vec3 off = p - k * b, other = p - clamp(shade, darkest, 1.0) * b;
  bool is_other = is_still && dot(other, other) > other_color * variance;
  return Room(dot(off, off) / variance, variance, is_other);
}

// By the learned light or, where that is nearer to the plate, by the light found around.
Room to_learned(vec3 p, vec3 known, float sigma, vec4 here) {
  vec3 b = min(shown_now(known), 1.0);
  float darkest = deepest_shadow;
  if (is_still) {
    // The darkest shadow is relative to the learned light.
    float least = deepest_shadow * luminance(b);
    b = nearer_to(p, b, here.rgb * b);
    darkest = min(least / max(luminance(b), 1e-4), 1.0);
  }
  return to_room(p, b, gain.g * sigma, here.a, darkest);
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
  vec4 here = is_still ? texelFetch(light, block, 0) : vec4(1, 1, 1, color_flicker);
  vote = 0.0;
  if (!has_learned && (around.a == 0.0 || !has_person)) return;
  vec3 off = p - around.rgb;
  float background2 = dot(off, off) / max(around.a, 1e-12), variance = around.a;
  bool no_shadow = false;  // the colour is no shadow of people on the learned background
  if (has_learned) {
    vec3 known = texelFetch(learned, at, 0).rgb;
    if (known.r < 0.0) return;  // unknown
    float sigma = has_sigma ? texelFetch(learned_sigma, at, 0).r : 0.0;
    Room found = to_learned(p, known, sigma, here);
    background2 = found.square;
    variance = found.variance;
    no_shadow = has_person && found.no_shadow;
  }
  float odds = 0.5 * background2 - color_vote_cap;
  if (has_person) {
    vec4 mean = vec4(texelFetch(person, block, 0).rgb, near.z);
    float person_odds = has_mean ? odds_of(p, mean, here.a) : -1e9;
    // Foreground around a pixel that shows the room may lie over the room itself.
    bool by_deep = has_deep && is_still && background2 < surely_room;
    if (has_deep) {
      float inner = odds_of(p, deep, here.a);
      person_odds = by_deep ? inner : max(person_odds, inner);
    }
    odds = 0.5 * background2 + spread_odds * log(variance) + person_odds;
  }
  float cap = has_learned ? color_vote_cap : room_vote_cap;
  vote = clamp(odds, -cap, no_shadow ? other_vote_cap : cap);
}
