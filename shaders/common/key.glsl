// SPDX-License-Identifier: Apache-2.0
// Pass key: definitions shared by its shaders. A state is render::PixelState in a byte, with
// state_mirrored added where the depth may be a mirror's; blocks are block_px wide. Needs
// common/constants.glsl.
const int unknown = 0, background = 1, foreground = 2, doubt = 3;

int state_byte(float stored) { return int(stored * 255.0 + 0.5); }
int to_state(float stored) { return state_byte(stored) & (state_mirrored - 1); }

// Sums over a block, held by three textures with one texel a block.
struct Block {
  float foreground;  // number of pixels
  float inner;       // number of those not drawn by a cut cell
  float w_sum;       // over foreground
  bool others;       // some pixel is not foreground
  bool doubt;        // some pixel is measured where the background has no depth
  bool dropped;      // its foreground was a speckle
  float mirrored;    // number of pixels with a mirror's depth
  bool by_mirror;    // unknown pixels are background
  vec3 color_sum;    // linear, over inner
  float square_sum;  // squares of all channels, over inner
  float room;        // number of background pixels, if its colour was not learned
  vec3 room_sum;     // linear, over those pixels
  float room_square_sum;
};

// Bit in the counts texture that stores by_mirror.
int by_mirror_flag() { return 1 << 17; }

const Block empty_block =
    Block(0.0, 0.0, 0.0, false, false, false, 0.0, false, vec3(0), 0.0, 0.0, vec3(0), 0.0);

Block read_block(sampler2D counts, sampler2D colors, sampler2D rooms, ivec2 at) {
  vec4 count = texelFetch(counts, at, 0), color = texelFetch(colors, at, 0);
  vec4 room = texelFetch(rooms, at, 0);
  int flags = int(count.w);
  return Block(count.x, count.y, count.z, (flags & 1) != 0, (flags & 2) != 0, (flags & 4) != 0,
               float((flags >> 10) & 127), (flags & by_mirror_flag()) != 0, color.rgb, color.a, float((flags >> 3) & 127), room.rgb, room.a);
}

vec4 counts_of(Block b) {
  int flags = (b.others ? 1 : 0) + (b.doubt ? 2 : 0) + (b.dropped ? 4 : 0) + 8 * int(b.room) +
              1024 * int(b.mirrored) + (b.by_mirror ? by_mirror_flag() : 0);
  return vec4(b.foreground, b.inner, b.w_sum, flags);
}
