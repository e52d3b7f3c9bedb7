#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass warp, first half: writes the triangles of all cells of four neighbouring ToF pixels. Vertex
// ids: y * width + x is a ToF pixel; from pixel_count on, pixel_count + 9 pixel + corner is one of
// the 3 x 3 corners, half a pixel apart, of the area that a ToF pixel owns in cut cells.
//   vertices  from correct_links.frag
//   draw      arguments of glDrawElementsIndirect; count must be 0 before
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/grid.glsl"
layout(local_size_x = 64) in;
layout(binding = 0) uniform sampler2D vertices;
layout(std430, binding = 0) buffer Draw { uint count, instances, first, base, reserved; } draw;
layout(std430, binding = 1) writeonly buffer Indices { uint index[]; };
shared uint group_count, group_first;

ivec2 size;
uint ids[cell_indices];
uint used = 0u;

void triangle(uint a, uint b, uint c) {
  ids[used] = a, ids[used + 1u] = b, ids[used + 2u] = c;
  used += 3u;
}

uint pixel_id(ivec2 at) { return uint(at.y * size.x + at.x); }

// Adds the quarter cell from pixel `at` towards the cell's middle, oriented like whole cells.
void quarter(ivec2 at, ivec2 to) {
  uint first = uint(size.x * size.y) + 9u * pixel_id(at);
  uint mid = first + 4u;
  uint side_x = first + uint(4 + to.x), side_y = first + uint(4 + 3 * to.y);
  uint far = first + uint(4 + to.x + 3 * to.y);
  bool swap = to.x * to.y < 0;
  triangle(mid, swap ? far : side_x, swap ? side_x : far);
  triangle(mid, swap ? side_y : far, swap ? far : side_y);
}

void cell(ivec2 at) {
  ivec2 x = ivec2(1, 0), y = ivec2(0, 1);
  vec2 a = texelFetch(vertices, at, 0).ra, b = texelFetch(vertices, at + x, 0).ra;
  vec2 c = texelFetch(vertices, at + y, 0).ra, d = texelFetch(vertices, at + x + y, 0).ra;
  bool known = min(min(a.x, b.x), min(c.x, d.x)) > 0.0;
  bool holds = (int(a.y) & 7) == 7 && (int(b.y) & 10) == 10 && (int(c.y) & 1) == 1;
  if (known && holds) {
    bool down_right = abs(a.x - d.x) <= abs(b.x - c.x);
    triangle(pixel_id(at), pixel_id(at + x), pixel_id(down_right ? at + x + y : at + y));
    triangle(pixel_id(down_right ? at : at + x), pixel_id(at + x + y), pixel_id(at + y));
    return;
  }
  if (a.x > 0.0) quarter(at, ivec2(1, 1));
  if (b.x > 0.0) quarter(at + x, ivec2(-1, 1));
  if (c.x > 0.0) quarter(at + y, ivec2(1, -1));
  if (d.x > 0.0) quarter(at + x + y, ivec2(-1, -1));
}

void main() {
  size = textureSize(vertices, 0);
  int cells_x = size.x - 1, i = int(gl_GlobalInvocationID.x);
  if (i < cells_x * (size.y - 1)) cell(place_in_grid(i, cells_x));
  // One request a group instead of one a cell.
  if (gl_LocalInvocationIndex == 0u) group_count = 0u;
  barrier();
  uint at = atomicAdd(group_count, used);
  barrier();
  if (gl_LocalInvocationIndex == 0u) group_first = atomicAdd(draw.count, group_count);
  barrier();
  for (uint k = 0u; k < used; ++k) index[group_first + at + k] = ids[k];
}
