// SPDX-License-Identifier: Apache-2.0
// Lamps with their shadow maps. Positions and normals in camera axes, light linear. Maps hold
// nearest_m / z in lamp axes, 0 for nothing. Needs common/constants.glsl, common/color.glsl and
// common/contact.glsl.
struct Lamp {
  mat4 lamp_from_camera;
  vec4 position_m, direction, intensity;  // direction 0: shines to all sides
  vec4 panel_u, panel_v;                  // passes.h
  float radius_m, map_focal_texel, map_center_texel, casters_near_m;
  // .x: size, 0 without map; .y: layer of room_share, or -1; .z: part_of; .w: is_part.
  ivec4 map_size_texel;
};
// From most_lamps on: the whole lamps, with their maps of people.
layout(std140, binding = 0) uniform Lamps {
  Lamp lamps[2 * most_lamps];
  mat4 cell_from_camera;  // for room_share
};
layout(binding = 7) uniform sampler2DArray shadow_maps;
layout(binding = 6) uniform sampler2DArray people_maps;
// Share of a lamp that the real room leaves (room_shade.h): grids along z, one a layer, trilinear.
layout(binding = 5) uniform sampler3D room_share;
uniform ivec3 room_cells;
uniform float room_lift_m;
uniform int lamp_count;
uniform vec3 ambient;

// Where the taps of a filter lie in a map.
struct Filter {
  int layer, size_texel;
  vec2 center, slope;  // texels; of the inverse depth of the surface's plane, a texel
  mat2 panel;
  float w;  // inverse depth of the point
};

// Place of tap k of n: panel_tap() of passes.h.
vec2 panel_tap(int k, int n) {
  float at = float(k) + 0.5;
  return vec2(2.0 * (at / float(n)) - 1.0, 2.0 * fract(tap_turn * at) - 1.0);
}

// Inverse lamp depth of the nearest texel to a tap; 0 outside.
float texel(sampler2DArray maps, Filter f, vec2 tap) {
  ivec2 t = ivec2(floor(f.center + tap + 0.5));
  bool inside = min(t.x, t.y) >= 0 && max(t.x, t.y) < f.size_texel;
  return inside ? texelFetch(maps, ivec3(t, f.layer), 0).r / nearest_m : 0.0;
}

// Inverse depth above which a tap hides a point: the larger of the point's own and that of its
// surface's plane at the tap.
float least_w(Filter f, vec2 tap) { return f.w + max(dot(f.slope, tap), 0.0); }

// Mean lamp depth of what lies before a point within the radius; 0 if nothing does.
float blocker_depth_m(sampler2DArray maps, Filter f, float radius, int taps) {
  float sum = 0.0, count = 0.0;
  for (int k = 0; k < taps; ++k) {
    vec2 tap = radius * f.panel * panel_tap(k, taps);
    float blocker = texel(maps, f, tap);
    if (blocker > least_w(f, tap)) sum += 1.0 / blocker, count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

// Share of the taps within the radius that do not hide a point.
float lit_share(sampler2DArray maps, Filter f, float radius, int taps) {
  float lit = 0.0;
  for (int k = 0; k < taps; ++k) {
    vec2 tap = radius * (f.panel * panel_tap(k, taps));
    lit += texel(maps, f, tap) > least_w(f, tap) ? 0.0 : 1.0;
  }
  return lit / float(taps);
}

// Share of a lamp that a point sees past its map (percentage-closer soft shadows, Fernando 2005):
// past the objects, or past people for a whole lamp. The normal is 0 for a surface that is not in
// the map and cannot shade itself. Compilers copy the function to each call, so that a program
// should have one.
float visibility(int layer, bool past_people, vec3 position_m, vec3 normal) {
  int i = past_people ? most_lamps + layer : layer;
  int size_texel = lamps[i].map_size_texel.x;
  if (size_texel == 0) return 1.0;
  float focal = lamps[i].map_focal_texel, near_m = lamps[i].casters_near_m;
  vec3 p = (lamps[i].lamp_from_camera * vec4(position_m, 1.0)).xyz;
  if (p.z <= near_m) return 1.0;
  // A texel spans z / focal metres; lifting by lift_texels moves the point off its own surface.
  vec3 n = mat3(lamps[i].lamp_from_camera) * normal;
  p += lift_texels * p.z / focal * n;
  if (p.z <= near_m) return 1.0;
  vec2 center = p.xy * (focal / p.z) + lamps[i].map_center_texel;
  float w = 1.0 / p.z, reach = focal * lamps[i].radius_m;
  // A point of the panel that is nearer than its centre appears shifted aside.
  vec2 ray = p.xy / p.z;
  vec3 u = lamps[i].panel_u.xyz, v = lamps[i].panel_v.xyz;
  mat2 panel = mat2(u.xy - u.z * ray, v.xy - v.z * ray);
  float search = max(reach * (1.0 / near_m - w), least_radius_texel);
  vec2 beside = search * (abs(panel[0]) + abs(panel[1]));
  vec2 last = float(size_texel - 1) + beside;
  if (any(lessThanEqual(center, -beside)) || any(greaterThanEqual(center, last))) return 1.0;
  // Slope of the surface's plane: inverse depth is affine over it.
  vec2 slope = n.xy * (w / (focal * min(dot(n, vec3(ray, 1)), steepest_cosine)));
  bool part = lamps[i].map_size_texel.w != 0;
  Filter f = Filter(layer, size_texel, center, slope, panel, w);
  int searched = part ? part_blocker_tap_count : blocker_tap_count;
  float blocker_m = past_people ? blocker_depth_m(people_maps, f, search, searched)
                                : blocker_depth_m(shadow_maps, f, search, searched);
  if (blocker_m <= 0.0) return 1.0;
  float radius = max(reach * (1.0 / blocker_m - w), least_radius_texel);
  int taps = part ? part_shadow_tap_count : shadow_tap_count;
  return past_people ? lit_share(people_maps, f, radius, taps)
                     : lit_share(shadow_maps, f, radius, taps);
}

// Share of a lamp that is visible past the real room.
float seen_in_room(int i, vec3 position_m, vec3 normal) {
  int layer = lamps[i].map_size_texel.y;
  if (layer < 0) return 1.0;
  vec3 cell = (cell_from_camera * vec4(position_m + room_lift_m * normal, 1.0)).xyz;
  cell = clamp(cell, vec3(0), vec3(room_cells - 1));
  cell.z += float(layer * room_cells.z);
  return texture(room_share, (cell + 0.5) / vec3(textureSize(room_share, 0))).r;
}

vec3 irradiance(int i, vec3 position_m, vec3 normal) {
  vec3 to_lamp = lamps[i].position_m.xyz - position_m;
  float distance2 = max(dot(to_lamp, to_lamp), least_distance2);
  vec3 direction = to_lamp / sqrt(distance2);
  bool is_panel = lamps[i].direction.xyz != vec3(0);
  float emitter = is_panel ? max(0.0, -dot(lamps[i].direction.xyz, direction)) : 1.0;
  return lamps[i].intensity.rgb * (max(0.0, dot(normal, direction)) * emitter / distance2);
}

// Luminance of the real scene's ambient light that objects leave.
float ambient_past_objects(vec3 position_m, vec3 normal) {
  if (contact_count == 0) return luminance(ambient);
  Contact contact = contact_at(position_m, normal, 0.0);
  return contact.open * luminance(ambient) + luminance(contact.sent);
}

// Luminance with the virtual objects over luminance without them.
float light_ratio(vec3 position_m, vec3 normal) {
  float with_objects = ambient_past_objects(position_m, normal), without = luminance(ambient);
  for (int i = 0; i < lamp_count; ++i) {
    float light = luminance(irradiance(i, position_m, normal));
    if (light <= 0.0) continue;
    light *= seen_in_room(i, position_m, normal);
    with_objects += light * visibility(i, false, position_m, vec3(0));
    without += light;
  }
  return without > 0.0 ? with_objects / without : 1.0;
}
