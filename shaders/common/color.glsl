// SPDX-License-Identifier: Apache-2.0
// Linear colour. Needs common/constants.glsl.
float luminance(vec3 c) { return dot(c, vec3(rec709_red, rec709_green, rec709_blue)); }

// Least variance of a colour, by noise and by flicker of light, a part of its luminance.
float floor_variance(vec3 c, float flicker) {
  float sigma = color_noise + flicker * luminance(c);
  return sigma * sigma;
}

// Variance of `count` colours around their mean, plus the least variance of a colour.
float variance_of(vec3 mean, float square_sum, float count) {
  float spread = (square_sum / max(count, 1.0) - dot(mean, mean)) / 3.0;
  return max(0.0, spread) + floor_variance(mean, color_flicker);
}

// Whichever of two colours is nearer to p; a where both are as far.
vec3 nearer_to(vec3 p, vec3 a, vec3 b) {
  return dot(p - b, p - b) < dot(p - a, p - a) ? b : a;
}
