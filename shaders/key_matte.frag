#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, over the blocks where votes decide: the final matte, refined and blended with the
// previous one, and the depth that follows from it. Elsewhere key_copy.frag draws.
//   voted, band  of key_decide.frag and key_fill.frag, and of key_band.frag
//   state, counts  of key_state.frag and key_speckles.frag
//   plate        linear light
//   line, people of key_lines.frag, bilinear over the centres of tiles
//   learned      background colour, linear, red negative where unknown
//   w            1/m, negative where a cut cell drew it; 0 unknown
//   light        of key_light.frag, for a still camera
//   plate_before, matte_before  of the frame before
//   matte        people, 0..1
//   visible_w    inverse depth of the visible real surface, 1/m, 0 unknown
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
#include "common/color.glsl"
#include "common/tone.glsl"
layout(binding = 0) uniform sampler2D voted;
layout(binding = 1) uniform sampler2D band;
layout(binding = 2) uniform sampler2D state;
layout(binding = 3) uniform sampler2D counts;
layout(binding = 4) uniform sampler2D plate;
layout(binding = 5) uniform sampler2D line;
layout(binding = 6) uniform sampler2D w;
layout(binding = 7) uniform sampler2D people;
layout(binding = 8) uniform sampler2D learned;
layout(binding = 9) uniform sampler2D plate_before;
layout(binding = 10) uniform sampler2D matte_before;
layout(binding = 11) uniform sampler2D light;
uniform bool refine, has_learned, has_before, has_light;
uniform int reach_px;
uniform int tile_px;
uniform vec2 parallax_px_m;
layout(location = 0) out float matte;
layout(location = 1) out float visible_w;

vec4 of_tiles(sampler2D tiles, ivec2 at) {
  vec2 uv = max((vec2(at) + 0.5) / float(tile_px) - 0.5, 0.0);
  ivec2 i = ivec2(uv), j = min(i + 1, textureSize(tiles, 0) - 1);
  vec2 f = uv - vec2(i);
  vec4 above = mix(texelFetch(tiles, i, 0), texelFetch(tiles, ivec2(j.x, i.y), 0), f.x);
  vec4 below = mix(texelFetch(tiles, ivec2(i.x, j.y), 0), texelFetch(tiles, j, 0), f.x);
  return mix(above, below, f.y);
}

// Light of the room now: the learned one or, where that is nearer to the plate, the light found
// around.
vec3 room_now(ivec2 at, vec3 p, vec3 known) {
  vec3 b = min(shown_now(known), 1.0);
  return has_light ? nearer_to(p, b, texelFetch(light, at / block_px, 0).rgb * b) : b;
}

// Mixes the people's share by the line with their share by both colours, by the latter's
// confidence.
float share_of_colors(ivec2 at, vec3 p, float share) {
  vec4 around = of_tiles(people, at);
  vec3 known = texelFetch(learned, at, 0).rgb;
  if (known.r < 0.0 || around.x < share_least) return share;
  vec3 b = room_now(at, p, known), root = around.yzw / around.x, f = root * root;
  vec3 apart = f - b, off = p - b;
  float by_colors = dot(off, apart) / max(dot(apart, apart), 1e-6);
  vec3 rest = off - by_colors * apart;
  float shade = clamp(dot(f, b) / max(dot(b, b), 1e-8), share_shadow, 1.0);
  vec3 unlike = f - shade * b;
  float sigma = share_noise + share_part * luminance(p), sigma2 = sigma * sigma;
  float unlike2 = dot(unlike, unlike);
  float sure = unlike2 / (unlike2 + share_apart * share_apart * sigma2) * sigma2 /
               (sigma2 + dot(rest, rest)) * max(4.0 * share * (1.0 - share), 0.0);
  return share + sure * (clamp(by_colors, 0.0, 1.0) - share);
}

float refined(ivec2 at) {
  vec4 l = of_tiles(line, at);
  vec3 p = texelFetch(plate, at, 0).rgb;
  float share = dot(l.rgb, sqrt(p)) + l.a;
  if (has_learned) share = share_of_colors(at, p, share);
  return floor(255.0 * clamp(0.5 + matte_gain * (share - 0.5), 0.0, 1.0) + 0.5) / 255.0;
}

bool is_foreground_at(ivec2 at) {
  return to_state(texelFetch(state, at, 0).r) == foreground &&
         (int(texelFetch(counts, at / block_px, 0).w) & 4) == 0;
}

// Matte of a pixel without that of the frame before.
float matte_now(ivec2 at) {
  bool decided = (int(texelFetch(band, at / block_px, 0).x) & 4) != 0;
  return refine && decided ? refined(at) : texelFetch(voted, at, 0).r;
}

// Nearest foreground of a whole cell beside a pixel: distance (beyond the reach: none, or the room
// by the matte), inverse depth, and whether people are surely there.
struct Beside {
  int px;
  float w;
  bool sure;
};

Beside beside(ivec2 at, ivec2 way) {
  ivec2 size = textureSize(state, 0);
  Beside found = Beside(fill_reach_px + 1, 0.0, false);
  for (int d = 1; d <= fill_reach_px; ++d) {
    at += way;
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) break;
    float whole_w = texelFetch(w, at, 0).r;
    if (whole_w > 0.0 && is_foreground_at(at)) {
      found = Beside(d, whole_w, false);
      break;
    }
  }
  if (found.w <= 0.0) return found;
  float share = matte_now(at);
  if (share < 0.5) return Beside(fill_reach_px + 1, 0.0, false);
  found.sure = share > fill_sure;
  return found;
}

// The better one of both sides of a pixel along a direction: the rear one where the ToF camera
// cannot see the place and people are surely there.
Beside nearest(Beside a, Beside b, float parallax) {
  bool both = max(a.px, b.px) <= fill_reach_px;
  float hidden_px = fill_shadow * parallax * abs(a.w - b.w), least_w = min(a.w, b.w);
  bool may_be_hidden = float(a.px + b.px - 1) <= hidden_px + fill_slack_px;
  bool differ = max(a.w, b.w) > fill_ratio * least_w;
  bool sure = a.w <= b.w ? a.sure : b.sure;
  Beside near = Beside(min(a.px, b.px), a.px <= b.px ? a.w : b.w, sure);
  if (both && may_be_hidden && differ && sure) near.w = least_w;
  return near;
}

bool differs(Beside side, float own) {
  return max(own, side.w) > fill_ratio * min(own, side.w);
}

// Inverse depth of people's pixel: its own, 0 if none, unless a cut cell drew it and whole cells
// contradict on all sides that have some; else that of the best side.
float people_w(ivec2 at, float own, bool is_cut, float otherwise) {
  if (own > 0.0 && !is_cut) return own;
  Beside left = beside(at, ivec2(-1, 0)), right = beside(at, ivec2(1, 0));
  Beside above = beside(at, ivec2(0, -1)), below = beside(at, ivec2(0, 1));
  Beside row = nearest(left, right, parallax_px_m.x);
  Beside column = nearest(above, below, parallax_px_m.y);
  bool some = min(row.px, column.px) <= fill_reach_px;
  if (own > 0.0 && (!some || !(differs(left, own) && differs(right, own) && differs(above, own) &&
                               differs(below, own))))
    return own;
  Beside near = row.px <= column.px ? row : column;
  return near.px <= fill_reach_px ? near.w : otherwise;
}

// Share of the previous matte, by how alike 3x3 pixels are.
float share_of_before(ivec2 at) {
  ivec2 last = textureSize(plate, 0) - 1;
  float sum = 0.0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      ivec2 here = clamp(at + ivec2(i, j), ivec2(0), last);
      vec3 a = texelFetch(plate, here, 0).rgb, b = texelFetch(plate_before, here, 0).rgb;
      // The roots of the three channels differ by sqrt(6) / 2 times this sum.
      sum += dot(abs(a - b), vec3(1)) * inversesqrt(dot(a + b, vec3(1)) + 2e-5);
    }
  float off = 255.0 / 27.0 * 1.2247449 * sum / before_alike;
  float t = max(0.0, 1.0 - 0.25 * off * off);  // to the fourth: nearly exp(-off * off)
  return before_share * t * t * t * t;
}

// False where the depth camera measures background at the pixel and on all sides.
bool may_be_people(ivec2 at) {
  ivec2 last = textureSize(state, 0) - 1;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      ivec2 beside = clamp(at + reach_px * ivec2(i, j), ivec2(0), last);
      int s = to_state(texelFetch(state, beside, 0).r);
      bool by_mirror = (int(texelFetch(counts, beside / block_px, 0).w) & by_mirror_flag()) != 0;
      if (s == doubt || (s == unknown && !by_mirror) || is_foreground_at(beside)) return true;
    }
  return false;
}

// Blends in the previous matte where the plate has not changed.
float steadied(ivec2 at, float now) {
  float then = texelFetch(matte_before, at, 0).r;
  if (then == now || (then > now && !may_be_people(at))) return now;
  return floor(255.0 * mix(now, then, share_of_before(at)) + 0.5) / 255.0;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), block = at / block_px;
  vec4 near = texelFetch(band, block, 0);
  matte = matte_now(at);
  float measured = abs(texelFetch(w, at, 0).r);
  visible_w = measured;
  if (has_before) matte = steadied(at, matte);
  bool is_foreground = is_foreground_at(at), is_person = matte > 0.0;
  if (!is_person && !is_foreground) return;
  float own = is_foreground ? measured : 0.0;
  visible_w = is_person ? people_w(at, own, texelFetch(w, at, 0).r < 0.0, near.y) : 0.0;
  // Doubt keeps a known depth that is nearer: virtual objects must not cover it.
  if (is_person && to_state(texelFetch(state, at, 0).r) == doubt)
    visible_w = max(measured, visible_w);
}
