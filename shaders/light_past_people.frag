#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass light: light that the room keeps beside the virtual objects where people hide a lamp, so
// that the plate is dark already. Drawn over the background's light.
//   background_m       z in metres, 0 unknown
//   background_normal  camera axes, 0 unknown
//   background_light   of light_background.frag
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
layout(std140, binding = 1) uniform PeopleLamps { Lamp people_lamps[most_lamps]; };
layout(binding = 6) uniform sampler2DArray people_maps;
out float light;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  light = texelFetch(background_light, at, 0).r;
  float z = texelFetch(background_m, at, 0).r;
  if (light >= 1.0 || z <= 0.0) return;
  vec3 ray = ray_of(at), stored = texelFetch(background_normal, at, 0).xyz;
  vec3 normal = normalize(stored == vec3(0) ? -ray : stored);
  bool hidden = false;  // people hide some lamp
  int whole_lamps = lamp_count > 0 ? lamps[lamp_count - 1].map_size_texel.z + 1 : 0;
  for (int i = 0; i < whole_lamps && !hidden; ++i)
    hidden = visibility_past(people_lamps[i], people_maps, i, ray * z, normal) < 1.0;
  if (!hidden) return;
  float with_objects = ambient_past_objects(ray * z, normal), without = luminance(ambient);
  int past_of = -1;
  float past = 1.0;
  for (int i = 0; i < lamp_count; ++i) {
    float of_lamp = luminance(irradiance(i, ray * z, normal));
    if (of_lamp <= 0.0) continue;
    int whole = lamps[i].map_size_texel.z;
    if (whole != past_of)
      past = visibility_past(people_lamps[whole], people_maps, whole, ray * z, normal);
    past_of = whole;
    of_lamp *= seen_in_room(i, ray * z, normal) * past;
    with_objects += of_lamp * visibility(i, ray * z, vec3(0));
    without += of_lamp;
  }
  light = without > 0.0 ? clamp(with_objects / without, 0.0, 1.0) : 1.0;
}
