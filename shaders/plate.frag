#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass plate: resamples the colour camera's picture through the lens into the view.
//   plate  sRGB bytes, decoded before the filter; clamped to the edge
//   color  linear light, opaque; the target encodes to sRGB again
// Pixel centres lie at whole numbers.
#include "common/precision.glsl"
layout(binding = 0) uniform sampler2D plate;
uniform vec2 view_focal_px, view_center_px, focal_px, center_px;  // of the view, of the camera
uniform float lens[8];                                            // k1 k2 p1 p2 k3 k4 k5 k6
uniform float domain_r2;  // of the lens; beyond it the picture's corner is shown
// Factor of light against vignetting, exp(a r2 + b r2^2): a and b, the principal point, and
// (half the picture's diagonal)^-2.
uniform bool has_gain;
uniform vec2 gain_terms, gain_center_px;
uniform float gain_r2_per_px2;
out vec4 color;

// Pixel of the camera for a ray (x/z, y/z): rational radial and tangential distortion.
vec2 plate_px(vec2 ray) {
  float r2 = dot(ray, ray);
  if (r2 > domain_r2) return vec2(0);
  float gain = (1.0 + r2 * (lens[0] + r2 * (lens[1] + r2 * lens[4]))) /
               (1.0 + r2 * (lens[5] + r2 * (lens[6] + r2 * lens[7])));
  vec2 p = vec2(lens[2], lens[3]);
  vec2 aside = 2.0 * ray.x * ray.y * p + p.yx * (r2 + 2.0 * ray * ray);
  return focal_px * (gain * ray + aside) + center_px;
}

void main() {
  vec2 at = plate_px((gl_FragCoord.xy - 0.5 - view_center_px) / view_focal_px);
  vec3 light = texture(plate, (at + 0.5) / vec2(textureSize(plate, 0))).rgb;
  if (has_gain) {
    vec2 off = at - gain_center_px;
    float r2 = gain_r2_per_px2 * dot(off, off);
    light *= clamp(exp(r2 * (gain_terms.x + r2 * gain_terms.y)), 0.125, 8.0);
  }
  color = vec4(light, 1.0);
}
