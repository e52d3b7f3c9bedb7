// SPDX-License-Identifier: Apache-2.0
// The view: an ideal pinhole, pixel centres at whole numbers.
uniform vec2 focal_px, center_px;

// (x/z, y/z, 1) of a pixel, camera axes.
vec3 ray_of(ivec2 at) { return vec3((vec2(at) - center_px) / focal_px, 1.0); }
