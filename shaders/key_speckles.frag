#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a block: turns foreground too small for a person, and unknown pixels beside a
// mirror's depth, into background.
//   counts, colors, rooms  blocks, in and out (common/key.glsl)
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
layout(binding = 0) uniform sampler2D counts;
layout(binding = 1) uniform sampler2D colors;
layout(binding = 2) uniform sampler2D rooms;
uniform float tof_px;  // view pixels that a ToF pixel covers
layout(location = 0) out vec4 kept_counts;
layout(location = 1) out vec4 kept_colors;
layout(location = 2) out vec4 kept_rooms;
uniform bool needs_room;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(counts, 0) - 1;
  Block b = read_block(counts, colors, rooms, at);
  vec2 sum = vec2(0), next = vec2(0);  // foreground, mirrored
  for (int y = max(0, at.y - speckle_blocks); y <= min(last.y, at.y + speckle_blocks); ++y)
    for (int x = max(0, at.x - speckle_blocks); x <= min(last.x, at.x + speckle_blocks); ++x) {
      vec4 count = texelFetch(counts, ivec2(x, y), 0);
      vec2 here = vec2(count.x, (int(count.w) >> 10) & 127);
      sum += here;
      if (abs(x - at.x) <= band_blocks && abs(y - at.y) <= band_blocks) next += here;
    }
  float least = sum.x < sum.y ? mirror_speckle_tof_px : speckle_tof_px;
  if (b.foreground > 0.0 && sum.x < least * tof_px)
    b = Block(0.0, 0.0, 0.0, true, b.doubt, true, b.mirrored, false, vec3(0), 0.0,
              b.room + (needs_room ? b.inner : 0.0),
              b.room_sum + (needs_room ? b.color_sum : vec3(0)),
              b.room_square_sum + (needs_room ? b.square_sum : 0.0));
  b.by_mirror = next.y > mirror_part * next.x;
  kept_counts = counts_of(b);
  kept_colors = vec4(b.color_sum, b.square_sum);
  kept_rooms = vec4(b.room_sum, b.room_square_sum);
}
