#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass mix: the composite (docs/method/compositor.md), drawn for blocks that people or objects may
// touch; mix_room.frag draws the others.
//   plate, learned      linear light; learned is the background's colour
//   room                one texel a block: colour of the background around, where none was learned
//   backdrop            linear: replaces the background
//   matte               people, 0..1
//   visible_w           visible real surface, 1/m, 0 unknown
//   background_m        z in metres, 0 unknown
//   light_map           0..1
//   virtual_color       linear, premultiplied by the coverage in alpha; virtual_w 1/m
//   color               linear (the target encodes to sRGB), the matte in alpha
//   mixed_m, segmented_m  z in metres, 0 unknown or without people; layer render::Layer / 255
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/tone.glsl"
layout(binding = 0) uniform sampler2D plate;
layout(binding = 1) uniform sampler2D matte;
layout(binding = 2) uniform sampler2D visible_w;
layout(binding = 3) uniform sampler2D background_m;
layout(binding = 4) uniform sampler2D learned;
layout(binding = 5) uniform sampler2D light_map;
layout(binding = 6) uniform sampler2D virtual_color;
layout(binding = 7) uniform sampler2D virtual_w;
layout(binding = 8) uniform sampler2D room;
layout(binding = 9) uniform sampler2D backdrop;
// keyed: there is a matte; shows_room: the real background is shown; open_walls: it hides nothing.
uniform bool keyed, has_background, has_color, has_light, has_objects;
uniform bool shows_room, open_walls, has_backdrop;
layout(binding = 10) uniform sampler2D grain_noise;  // sigma 1 / grain_sigmas, repeats
uniform bool has_grain;
uniform ivec2 grain_offset;
uniform vec3 grain_floor, grain_slope;  // variance of the noise: floor + slope * light
layout(location = 0) out vec4 color;
layout(location = 1) out float mixed_m;
layout(location = 2) out float segmented_m;
layout(location = 3) out float layer;

// The background's own colour under the light map; red is negative if unknown.
vec3 room_color(ivec2 at, float light) {
  if (has_color) {
    vec3 known = texelFetch(learned, at, 0).rgb;
    return known.r >= 0.0 ? min(shown_now(known), 1.0) * light : vec3(-1);
  }
  if (!keyed) return vec3(-1);
  vec4 around = texelFetch(room, at / block_px, 0);
  return around.a > 0.0 ? around.rgb * light : vec3(-1);
}

// Share of the background: a wrong matte takes no more background out of a pixel than is in it.
float room_share(vec3 real, vec3 empty, float a) {
  vec3 most = real / max(empty, 1e-10);
  return min(1.0 - a, min(most.r, min(most.g, most.b)));
}

// A person's contribution to a pixel: colour times matte.
vec3 person_alone(vec3 real, vec3 empty, float a) {
  if (a == 0.0 || a >= 1.0) return a * real;
  return empty.r >= 0.0 ? real - room_share(real, empty, a) * empty : a * real;
}

// Shaded colour with the sensor's noise.
vec3 with_grain(vec4 shaded, ivec2 at) {
  vec3 noise = texelFetch(grain_noise, (at + grain_offset) & ivec2(grain_texels - 1), 0).rgb;
  vec3 sigma = sqrt(grain_floor + grain_slope * (shaded.rgb / shaded.a));
  return max(shaded.rgb + grain_sigmas * shaded.a * sigma * noise, 0.0);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float a = keyed ? texelFetch(matte, at, 0).r : 0.0;
  bool is_person = a >= person_matte;
  float w = abs(texelFetch(visible_w, at, 0).r);
  float measured = w > 0.0 ? 1.0 / w : 0.0;
  float known = has_background ? texelFetch(background_m, at, 0).r : 0.0;
  float behind = known > 0.0 ? known : a > 0.0 ? 0.0 : measured;
  float light = has_light ? texelFetch(light_map, at, 0).r : 1.0;
  vec3 real = texelFetch(plate, at, 0).rgb * light;
  vec3 far = has_backdrop ? texelFetch(backdrop, at, 0).rgb : vec3(0);
  vec3 empty = room_color(at, light);
  vec3 person = person_alone(real, empty, a);
  color = vec4(shows_room ? real : person + (1.0 - a) * far, a);
  segmented_m = is_person ? measured : 0.0;
  mixed_m = is_person ? measured : shows_room ? behind : 0.0;
  layer = is_person ? 1.0 / 255.0 : 0.0;
  if (!has_objects) return;
  vec4 shaded = texelFetch(virtual_color, at, 0);
  if (shaded.a == 0.0) return;
  shaded.rgb = shown_now(shaded.rgb / shaded.a) * shaded.a;
  if (has_grain) shaded.rgb = with_grain(shaded, at);
  float z = 1.0 / texelFetch(virtual_w, at, 0).r;
  // A surface that the object touches does not hide it; unknown depth never hides.
  bool hides = shows_room && !open_walls;
  if (hides && behind > 0.0 && z > behind + contact_slack_m) return;
  bool person_before = a > 0.0 && measured > 0.0 && measured < z;
  if (!person_before)
    color.rgb = shaded.rgb + (1.0 - shaded.a) * color.rgb;
  else if (!shows_room)
    color.rgb = person + (1.0 - a) * (shaded.rgb + (1.0 - shaded.a) * far);
  else if (a < 1.0) {
    if (empty.r < 0.0) empty = real;
    color.rgb = real + room_share(real, empty, a) * (shaded.rgb - shaded.a * empty);
  }
  if (shaded.a < virtual_share || (is_person && person_before)) return;
  mixed_m = z;
  layer = 2.0 / 255.0;
}
