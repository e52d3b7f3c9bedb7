#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light, over the blocks of light_blocks.frag: light that the room keeps beside the virtual
// objects where people hide a lamp, so that the plate is dark already. Drawn over the background's
// light.
//   background_m       z in metres, 0 unknown
//   background_normal  camera axes, 0 unknown
//   background_light   of light_background.frag
//   hides              of light_hidden.frag: more than 0 where people hide a lamp
//   light              0..1
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/color.glsl"
#include "common/view.glsl"
#include "common/contact.glsl"
#include "common/lamps.glsl"
layout(binding = 0) uniform sampler2D background_m;
layout(binding = 1) uniform sampler2D background_normal;
layout(binding = 2) uniform sampler2D background_light;
layout(binding = 3) uniform sampler2D hides;
out float light;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  light = texelFetch(background_light, at, 0).r;
  if (texelFetch(hides, at, 0).r <= 0.0) return;
  vec3 position_m = ray_of(at) * texelFetch(background_m, at, 0).r;
  vec3 normal = normal_of(background_normal, at);
  float with_objects = ambient_past_objects(position_m, normal), without = luminance(ambient);
  int past_of = -1;
  float past = 1.0;
  for (int i = 0; i < lamp_count; ++i) {
    float of_lamp = luminance(irradiance(i, position_m, normal));
    if (of_lamp <= 0.0) continue;
    int whole = lamps[i].map_size_texel.z;
    float seen = 1.0;
    // Past people, once for the parts of a lamp, then past the objects.
    for (int k = whole != past_of ? 0 : 1; k < 2; ++k) {
      bool past_people = k == 0;
      seen = visibility(past_people ? whole : i, past_people, position_m,
                        past_people ? normal : vec3(0));
      if (past_people) past = seen;
    }
    past_of = whole;
    of_lamp *= seen_in_room(i, position_m, normal) * past;
    with_objects += of_lamp * seen;
    without += of_lamp;
  }
  light = without > 0.0 ? clamp(with_objects / without, 0.0, 1.0) : 1.0;
}
