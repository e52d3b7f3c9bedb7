// SPDX-License-Identifier: Apache-2.0
// Linear colour. Needs common/constants.glsl.
float luminance(vec3 c) { return dot(c, vec3(rec709_red, rec709_green, rec709_blue)); }

// Least variance of a colour: noise, and flicker of light.
float floor_variance(vec3 c) {
  float sigma = color_noise + color_flicker * luminance(c);
  return sigma * sigma;
}
