#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass shadow, one pixel a block: the ball that stands for the person in it, as thick as the
// silhouette is wide, and no deeper than the back of the body around.
//   people_w  of people_w.frag
//   ball      centre in camera axes, metres, and radius; 0 for nobody
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/view.glsl"
layout(binding = 0) uniform sampler2D people_w;
out vec4 ball;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(people_w, 0) - 1;
  float w = texelFetch(people_w, at, 0).r;
  ball = vec4(0);
  if (w <= 0.0) return;
  float block_m = float(block_px) / (w * focal_px.x);
  bool small = block_m < small_block_m;  // every second block has a ball
  if (small && ((at.x | at.y) & 1) != 0) return;
  int reach = clamp(int(ceil(people_radius_m / block_m + 0.5)), 1, most_ball_blocks);
  int nearest2 = reach * reach;
  // How far the nearest part of the same body lies before it; parts nearer by more are limbs.
  float behind = 0.0;
  for (int y = max(0, at.y - reach); y <= min(last.y, at.y + reach); ++y)
    for (int x = max(0, at.x - reach); x <= min(last.x, at.x + reach); ++x) {
      float other = texelFetch(people_w, ivec2(x, y), 0).r;
      bool same = other > 0.0 && abs(1.0 / other - 1.0 / w) < people_step_m;
      ivec2 d = ivec2(x, y) - at;
      if (!same) nearest2 = min(nearest2, d.x * d.x + d.y * d.y);
      float ahead = same ? 1.0 / w - 1.0 / other : 0.0;
      if (ahead < people_radius_m) behind = max(behind, ahead);
    }
  float radius = min(people_radius_m - 0.5 * behind, (sqrt(float(nearest2)) - 0.5) * block_m);
  radius = max(radius, least_ball_blocks * (small ? 2.0 : 1.0) * block_m);
  vec2 px = vec2(at * block_px) + 0.5 * float(block_px - 1);
  vec3 ray = vec3((px - center_px) / focal_px, 1.0);
  ball = vec4(ray / w + radius * normalize(ray), radius);
}
