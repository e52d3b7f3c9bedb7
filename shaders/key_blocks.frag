#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass key, one pixel a block: sums over the block's pixels (common/key.glsl).
//   state  of key_state.frag
//   w      1/m, negative where a cut cell drew it
//   plate  linear light, view
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/key.glsl"
layout(binding = 0) uniform sampler2D state;
layout(binding = 1) uniform sampler2D w;
layout(binding = 2) uniform sampler2D plate;
layout(location = 0) out vec4 counts;
layout(location = 1) out vec4 colors;
layout(location = 2) out vec4 rooms;
uniform bool needs_room;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * block_px;
  ivec2 last = min(first + block_px, textureSize(state, 0));
  Block b = empty_block;
  for (int y = first.y; y < last.y; ++y)
    for (int x = first.x; x < last.x; ++x) {
      ivec2 at = ivec2(x, y);
      float stored = texelFetch(state, at, 0).r;
      int s = to_state(stored);
      b.others = b.others || s != foreground;
      b.doubt = b.doubt || s == doubt;
      float pixel_w = texelFetch(w, at, 0).r, measured = abs(pixel_w);
      if (state_byte(stored) >= state_mirrored) b.mirrored += 1.0;
      if (needs_room && s == background) {
        vec3 color = texelFetch(plate, at, 0).rgb;
        b.room += 1.0;
        b.room_sum += color;
        b.room_square_sum += dot(color, color);
      }
      if (s != foreground) continue;
      b.foreground += 1.0;
      b.w_sum += measured;
      if (pixel_w < 0.0) continue;
      vec3 color = texelFetch(plate, at, 0).rgb;
      b.inner += 1.0;
      b.color_sum += color;
      b.square_sum += dot(color, color);
    }
  counts = counts_of(b);
  colors = vec4(b.color_sum, b.square_sum);
  rooms = vec4(b.room_sum, b.room_square_sum);
}
