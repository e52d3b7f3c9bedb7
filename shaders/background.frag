#version 310 es
// SPDX-License-Identifier: Apache-2.0
// Pass background: looks up in the model the surface that a pixel shows at this pose.
//   w             1/m of the drawn model, sign aside, 0 unknown
//   model_sigma_m sigma of the model's depth
//   model_normal  axes of the first face, 0 unknown; alpha: its plane number over 127, 0 none,
//                 negative where the depth has wrapped around and the plane lies behind it
//   model_w       1/m of the model, 0 unknown
//   depth         how well the model saw the surface; with several models the best one is kept
//   depth_m       z in metres, 0 unknown; spread_m: sigma of the model's depth
//   light_m       z of the surface on which light is computed: on planes of the model
//   normal        camera axes, 0 unknown
#include "common/precision.glsl"
#include "common/constants.glsl"
#include "common/view.glsl"
#include "common/model.glsl"
layout(binding = 0) uniform sampler2D w;
layout(binding = 1) uniform sampler2D model_sigma_m;
layout(binding = 2) uniform sampler2D model_normal;
layout(binding = 3) uniform sampler2D model_w;
layout(location = 0) out float depth_m;
layout(location = 1) out float spread_m;
layout(location = 2) out vec4 normal;
layout(location = 3) out float light_m;
// (x/z, y/z, 1) . plane = 1/z; the first entry means no plane.
uniform vec3 planes[most_light_planes + 1];

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float measured = abs(texelFetch(w, at, 0).r);
  depth_m = measured > 0.0 ? 1.0 / measured : 0.0;
  spread_m = 0.0;
  normal = vec4(0);
  light_m = depth_m;
  gl_FragDepth = 0.0;
  ModelPlace place = place_in_model(at, measured, textureSize(model_sigma_m, 0));
  if (!place.inside) return;
  bool seen = is_seen(place, texelFetch(model_w, place.nearest, 0).r);
  if (several && !seen) return;
  if (seen) gl_FragDepth = place.score;
  spread_m = texelFetch(model_sigma_m, place.nearest, 0).r;
  vec4 stored = texelFetch(model_normal, place.nearest, 0);
  // The inverse of a rotation is its transpose.
  normal = vec4(stored.xyz * first_face_rotation(), 0);
  float on = dot(planes[int(round(127.0 * abs(stored.a)))], ray_of(at));
  if (!(on > 1.0 / farthest_m && on < 1.0 / nearest_m)) return;
  bool behind = stored.a < 0.0 && on < measured;
  if (behind || abs(on - measured) <= light_plane_part * measured) light_m = 1.0 / on;
  if (behind) depth_m = light_m;
}
