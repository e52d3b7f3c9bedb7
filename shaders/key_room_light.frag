#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a block near votes: light of the room over the learned light.
//   band    of key_band.frag
//   state, counts  of key_state.frag and key_speckles.frag
//   plate   linear light, view
//   learned  background colour, linear, red negative where unknown, and its sigma
//   found   light and squared change within the block; 0 where depth shows more than the room, too
//           few pixels are known, or they differ in more than light (frame/room_light.h)
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
#include "common/color.glsl"
#include "common/tone.glsl"
layout(binding = 0) uniform sampler2D band;
layout(binding = 1) uniform sampler2D state;
layout(binding = 2) uniform sampler2D counts;
layout(binding = 3) uniform sampler2D plate;
layout(binding = 4) uniform sampler2D learned;
layout(binding = 5) uniform sampler2D learned_sigma;
uniform bool has_sigma;
out vec4 found;

bool near_votes(ivec2 block) {
  ivec2 last = textureSize(band, 0) - 1;
  for (int y = max(0, block.y - 2); y <= min(last.y, block.y + 2); ++y)
    for (int x = max(0, block.x - 2); x <= min(last.x, block.x + 2); ++x)
      if ((int(texelFetch(band, ivec2(x, y), 0).x) & 4) != 0) return true;
  return false;
}

void main() {
  ivec2 block = ivec2(gl_FragCoord.xy), first = block * block_px;
  found = vec4(0);
  vec4 count = texelFetch(counts, block, 0);
  if (count.x > 0.0 || !near_votes(block)) return;
  bool speckle = (int(count.w) & 4) != 0, by_mirror = (int(count.w) & by_mirror_flag()) != 0;
  ivec2 end = min(first + block_px, textureSize(plate, 0));
  float n = 0.0, noise2 = 0.0;
  vec3 plate_sum = vec3(0), learned_sum = vec3(0), pp = vec3(0), pb = vec3(0), bb = vec3(0);
  for (int y = first.y + room_light_row; y < end.y; y += room_light_rows)
    for (int x = first.x; x < end.x; ++x) {
      int s = to_state(texelFetch(state, ivec2(x, y), 0).r);
      bool room = s == background || (s == foreground && speckle) || (s == unknown && by_mirror);
      vec3 p = texelFetch(plate, ivec2(x, y), 0).rgb, known = texelFetch(learned, ivec2(x, y), 0).rgb;
      vec3 b = min(shown_now(known), 1.0);
      float light = luminance(b), now = luminance(p);
      if (!room || known.r < 0.0 || now <= deepest_shadow * light || now >= room_light_most * light)
        continue;
      n += 1.0;
      plate_sum += p;
      learned_sum += b;
      pp += p * p;
      pb += p * b;
      bb += b * b;
      float sigma = has_sigma ? gain.g * texelFetch(learned_sigma, ivec2(x, y), 0).r : 0.0;
      noise2 += sigma * sigma + color_noise * color_noise;
    }
  if (n < room_light_least) return;
  vec3 rest = pp - pb * pb / max(bb, vec3(1e-8));
  float mean = luminance(learned_sum) / n;
  float change2 = (dot(rest, vec3(1.0 / 3.0)) - noise2) / (n * mean * mean + 1e-8);
  if (change2 > room_light_rest * room_light_rest) return;
  vec3 light = (plate_sum + n * color_noise) / (learned_sum + n * color_noise);
  float least = min(min(light.r, light.g), light.b), most = max(max(light.r, light.g), light.b);
  if (least >= room_light_hue * most) found = vec4(light, max(0.0, change2));
}
