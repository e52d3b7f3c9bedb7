#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass plate: resamples the colour camera's picture through the lens into the view.
//   plate     sRGB bytes, decoded before the filter; plate pixels, clamped to the edge
//   plate_px  plate pixel of each view pixel, pixel centres at whole numbers
//   gain      factor of each view pixel against the lens's vignetting, if has_gain
//   color     linear light, opaque; the target encodes to sRGB again
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D plate;
layout(binding = 1) uniform sampler2D plate_px;
layout(binding = 2) uniform sampler2D gain;
uniform bool has_gain;
out vec4 color;

void main() {
  vec2 at = texelFetch(plate_px, ivec2(gl_FragCoord.xy), 0).xy;
  vec3 light = texture(plate, (at + 0.5) / vec2(textureSize(plate, 0))).rgb;
  if (has_gain) light *= texelFetch(gain, ivec2(gl_FragCoord.xy), 0).r;
  color = vec4(light, 1.0);
}
