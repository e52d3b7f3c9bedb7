#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass background: looks up the learned colour of the surface that a pixel shows.
//   w             1/m of the drawn model, sign aside, 0 unknown
//   model_w       1/m of the model, 0 unknown
//   model_color   sRGB, bilinear, color_factor times as large; alpha: sigma of a channel in steps
//                 of most_spread / 254, 255 where unknown
//   depth         how well the model saw the surface; with several models the best one is kept
//   learned       linear light, -1 where unknown; learned_sigma its sigma
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/view.glsl"
#include "common/model.glsl"
layout(binding = 0) uniform sampler2D w;
layout(binding = 1) uniform sampler2D model_w;
layout(binding = 2) uniform sampler2D model_color;
uniform int color_factor;
uniform float most_spread;
layout(location = 0) out vec4 learned;
layout(location = 1) out float learned_sigma;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  learned = vec4(-1);
  learned_sigma = 0.0;
  gl_FragDepth = 0.0;
  ModelPlace place = place_in_model(at, abs(texelFetch(w, at, 0).r), textureSize(model_w, 0));
  if (!place.inside) return;
  float seen_w = texelFetch(model_w, place.nearest, 0).r;
  bool seen = is_seen(place, seen_w);
  if (several && !seen) return;
  vec2 px = (place.px + 0.5) * float(color_factor);
  if (texelFetch(model_color, ivec2(px), 0).a == 1.0) return;
  // Where the model saw another surface in front, its colour is not this surface's.
  if (seen_w > 0.0 && abs(1.0 - place.z_m * seen_w) > hidden_part) return;
  if (seen) gl_FragDepth = place.score;
  vec4 color = textureLod(model_color, px / vec2(textureSize(model_color, 0)), 0.0);
  learned = vec4(color.rgb, 1);
  learned_sigma = color.a * most_spread * 255.0 / 254.0;
}
