// SPDX-License-Identifier: Apache-2.0
// The view: an ideal pinhole, pixel centres at whole numbers.
uniform vec2 focal_px, center_px;

// (x/z, y/z, 1) of a pixel, camera axes.
vec3 ray_of(ivec2 at) { return vec3((vec2(at) - center_px) / focal_px, 1.0); }

// Unit normal of the surface in a pixel, from a picture of them; towards the camera for 0, unknown.
vec3 normal_of(sampler2D normals, ivec2 at) {
  vec3 stored = texelFetch(normals, at, 0).xyz;
  return normalize(stored == vec3(0) ? -ray_of(at) : stored);
}
