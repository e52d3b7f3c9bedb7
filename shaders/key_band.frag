#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a block: where votes decide, and people's colours that they compare with.
//   counts, colors, rooms  blocks without speckles (common/key.glsl)
//   band    1 near foreground + 2 in the band + 4 votes decide + 8 has colour + 16 may show
//           people; mean w of the foreground around; variance of its colour; matte where no
//           vote decides
//   person  mean colour of the foreground around, linear
//   room    mean colour of the background around, linear, and its variance; 0 if not known
//   person_deep  of the nearest block of `deep` (key_deep.frag); of several, the first row by row
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
#include "common/color.glsl"
layout(binding = 0) uniform sampler2D counts;
layout(binding = 1) uniform sampler2D colors;
layout(binding = 2) uniform sampler2D rooms;
layout(binding = 3) uniform sampler2D deep;
layout(location = 0) out vec4 band;
layout(location = 1) out vec4 person;
layout(location = 2) out vec4 room;
layout(location = 3) out vec4 person_deep;

Block sum_around(ivec2 at, int radius) {
  ivec2 last = textureSize(counts, 0) - 1;
  Block sum = empty_block;
  for (int y = max(0, at.y - radius); y <= min(last.y, at.y + radius); ++y)
    for (int x = max(0, at.x - radius); x <= min(last.x, at.x + radius); ++x) {
      Block b = read_block(counts, colors, rooms, ivec2(x, y));
      sum.foreground += b.foreground;
      sum.inner += b.inner;
      sum.w_sum += b.w_sum;
      sum.color_sum += b.color_sum;
      sum.square_sum += b.square_sum;
      sum.others = sum.others || b.others;
      sum.room += b.room;
      sum.room_sum += b.room_sum;
      sum.room_square_sum += b.room_square_sum;
    }
  return sum;
}

vec4 nearest_deep(ivec2 at) {
  ivec2 last = textureSize(deep, 0) - 1;
  vec4 found = vec4(0);
  int nearest = 2 * (deep_blocks + 1) * (deep_blocks + 1);
  for (int y = max(0, at.y - deep_blocks); y <= min(last.y, at.y + deep_blocks); ++y)
    for (int x = max(0, at.x - deep_blocks); x <= min(last.x, at.x + deep_blocks); ++x) {
      ivec2 d = ivec2(x, y) - at;
      int away = d.x * d.x + d.y * d.y;
      if (away >= nearest) continue;
      vec4 color = texelFetch(deep, ivec2(x, y), 0);
      if (color.a > 0.0) found = color, nearest = away;
    }
  return found;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  Block own = read_block(counts, colors, rooms, at);
  Block around = sum_around(at, near_blocks);
  bool near = around.foreground > 0.0;
  Block next = sum_around(at, band_blocks);
  bool in_band = near && next.foreground > 0.0 && next.others;
  if (in_band) around = next;
  bool votes = in_band || own.doubt || (near && own.others);
  bool has_color = around.inner >= float(block_px);
  float w = around.foreground > 0.0 ? around.w_sum / around.foreground : 0.0;
  vec3 mean = has_color ? around.color_sum / around.inner : vec3(0);
  float variance = variance_of(mean, around.square_sum, around.inner);
  bool people = votes || own.foreground > 0.0;
  int flags = (near ? 1 : 0) + (in_band ? 2 : 0) + (votes ? 4 : 0) + (has_color ? 8 : 0) +
              (people ? 16 : 0);
  band = vec4(flags, w, variance, own.foreground > 0.0 ? 1.0 : 0.0);
  person = vec4(mean, 1.0);
  vec3 room_mean = around.room_sum / max(around.room, 1.0);
  bool has_room = around.room >= float(block_px);
  room = has_room ? vec4(room_mean, variance_of(room_mean, around.room_square_sum, around.room))
                  : vec4(0);
  person_deep = votes ? nearest_deep(at) : vec4(0);
}
