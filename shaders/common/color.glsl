// SPDX-License-Identifier: Apache-2.0
// Linear colour.
float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// Least variance of a colour: noise, and flicker of light.
float floor_variance(vec3 c) {
  float sigma = 0.004 + 0.05 * luminance(c);
  return sigma * sigma;
}
