#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass plate: turns a picture in its camera's format into sRGB, bit for bit as pixel_of()
// (hal/base/raw_picture.h) does.
//   raw      samples: luma in red and chroma in green for YUYV, else one a texel
//   chroma   u and v of NV12, half the size; not read for other formats
//   samples  sRGB bytes of the 256 values of a sample, where has_samples
//   ramp     sRGB bytes 0 to 255, so that a fetch gives their linear light
//   color    linear light, opaque; the target encodes to sRGB again
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D raw;
layout(binding = 1) uniform sampler2D chroma;
layout(binding = 2) uniform sampler2D samples;
layout(binding = 3) uniform sampler2D ramp;
uniform bool is_yuyv, is_nv12, is_bayer, has_samples;
uniform ivec2 size, red_at;
uniform ivec3 luma;         // scale, shift, offset
uniform ivec2 red_blue;     // factor of v for red, of u for blue
uniform ivec3 green_shift;  // factors of u and v for green; shift of the sums
out vec4 color;

ivec3 bytes_of(vec3 texel) { return ivec3(texel * 255.0 + 0.5); }
int sample_at(ivec2 at) { return bytes_of(texelFetch(raw, at, 0).rgb).r; }
ivec3 table_at(int value) { return bytes_of(texelFetch(samples, ivec2(value, 0), 0).rgb); }

ivec3 rgb_of(int y, ivec2 uv) {
  ivec2 c = uv - 128;
  int base = (y * luma.x >> luma.y) + luma.z;
  ivec3 sum = base + ivec3(red_blue.x * c.y, green_shift.x * c.x + green_shift.y * c.y,
                           red_blue.y * c.x);
  return clamp(sum >> green_shift.z, 0, 255);
}

ivec3 yuyv_at(ivec2 at) {
  int pair = at.x & ~1;
  ivec3 first = bytes_of(texelFetch(raw, ivec2(pair, at.y), 0).rgb);
  ivec3 second = bytes_of(texelFetch(raw, ivec2(pair + 1, at.y), 0).rgb);
  return rgb_of(at.x == pair ? first.r : second.r, ivec2(first.g, second.g));
}

ivec3 nv12_at(ivec2 at) {
  return rgb_of(sample_at(at), bytes_of(texelFetch(chroma, at / 2, 0).rgb).rg);
}

// Index mirrored at the ends; a side of one pixel has only itself.
int mirrored(int at, int count) {
  return count == 1 ? 0 : at < 0 ? -at : at >= count ? 2 * count - 2 - at : at;
}

// sRGB value of the colour that the Bayer filter passes at a pixel.
int bayer_sample(ivec2 at) {
  int value = sample_at(ivec2(mirrored(at.x, size.x), mirrored(at.y, size.y)));
  if (!has_samples) return value;
  bool red_row = (at.y & 1) == red_at.y, red_column = (at.x & 1) == red_at.x;
  ivec3 of = table_at(value);
  return red_row != red_column ? of.g : red_row ? of.r : of.b;
}

int pair_mean(ivec2 at, ivec2 step) {
  return (bayer_sample(at - step) + bayer_sample(at + step) + 1) / 2;
}
int cross_mean(ivec2 at, ivec2 a, ivec2 b) {
  return (bayer_sample(at - a) + bayer_sample(at + a) + bayer_sample(at - b) +
          bayer_sample(at + b) + 2) / 4;
}

ivec3 bayer_at(ivec2 at) {
  bool red_row = (at.y & 1) == red_at.y;
  int own = bayer_sample(at);
  if (((at.x & 1) == red_at.x) == red_row) {  // a red or blue sample
    int green = cross_mean(at, ivec2(1, 0), ivec2(0, 1));
    int other = cross_mean(at, ivec2(1, 1), ivec2(1, -1));
    return red_row ? ivec3(own, green, other) : ivec3(other, green, own);
  }
  int across = pair_mean(at, ivec2(1, 0)), along = pair_mean(at, ivec2(0, 1));
  return red_row ? ivec3(across, own, along) : ivec3(along, own, across);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  ivec3 srgb = is_yuyv ? yuyv_at(at)
               : is_nv12 ? nv12_at(at)
               : is_bayer ? bayer_at(at) : ivec3(sample_at(at));
  if (has_samples && !is_bayer)
    srgb = ivec3(table_at(srgb.r).r, table_at(srgb.g).g, table_at(srgb.b).b);
  color = vec4(texelFetch(ramp, ivec2(srgb.r, 0), 0).r, texelFetch(ramp, ivec2(srgb.g, 0), 0).g,
               texelFetch(ramp, ivec2(srgb.b, 0), 0).b, 1.0);
}
