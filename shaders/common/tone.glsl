// SPDX-License-Identifier: Apache-2.0
// The camera's tones relative to those when the background was learned (render::ToneCurve). Needs
// common/constants.glsl.
uniform vec3 gain;        // of most of the picture
uniform bool tone_bends;  // false: every slope equals the gain
uniform vec3 tone_slope[tone_pieces];

vec3 shown_now(vec3 light) {
  if (!tone_bends) return gain * light;
  vec3 sum = tone_slope[0] * min(light, tone_first_knot);
  float knot = tone_first_knot;
  for (int i = 1; i < tone_pieces; ++i, knot *= 2.0) {
    vec3 above = max(light - knot, 0.0);
    sum += tone_slope[i] * (i + 1 < tone_pieces ? min(above, knot) : above);
  }
  return sum;
}
