#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass background: the learned colour of the surface that a pixel shows.
//   w             1/m of the drawn model, sign aside, 0 unknown
//   model_w       1/m of the model, 0 unknown
//   model_color   linear light, bilinear; red negative where unknown
//   model_spread  of a channel
//   learned       linear light, -1 where unknown; learned_sigma its spread
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/view.glsl"
#include "common/model.glsl"
layout(binding = 0) uniform sampler2D w;
layout(binding = 1) uniform sampler2D model_w;
layout(binding = 2) uniform sampler2D model_color;
layout(binding = 3) uniform sampler2D model_spread;
layout(location = 0) out vec4 learned;
layout(location = 1) out float learned_sigma;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(model_color, 0);
  learned = vec4(-1);
  learned_sigma = 0.0;
  ModelPlace place = place_in_model(at, abs(texelFetch(w, at, 0).r), size);
  if (!place.inside || texelFetch(model_color, place.nearest, 0).r < 0.0) return;
  // The model saw another surface before this one: that one's colour says nothing about it.
  float seen_w = texelFetch(model_w, place.nearest, 0).r;
  if (seen_w > 0.0 && abs(1.0 - place.z_m * seen_w) > hidden_part) return;
  vec2 uv = (place.px + 0.5) / vec2(size);
  learned = vec4(max(textureLod(model_color, uv, 0.0).rgb, vec3(0)), 1);
  learned_sigma = textureLod(model_spread, uv, 0.0).r;
}
