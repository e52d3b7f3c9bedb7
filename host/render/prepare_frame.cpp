// SPDX-License-Identifier: Apache-2.0
// Transforms of a frame: lamps, their shadow maps and the virtual objects in camera axes.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/gtc/matrix_inverse.hpp>

#include "host/render/prepare.h"

namespace mixrig::render {
namespace {

constexpr double kLargestTanHalf = 3.0;  // a map sees 143 degrees at most
/// Along an axis, so that the border of a shadow where an object touches the floor is that of a
/// pixel.
constexpr int kMapTexelsPerPixel = 2;
constexpr int kSmallestMap = 256, kLargestMap = 1024;
// The four maps of a panel's parts have as many texels as the largest one of all of it.
constexpr int kLargestPartMap = 512;
/// Texels across a map of people: 2 cm on the floor under a lamp that sees 143 degrees; around the
/// objects alone fewer will do.
constexpr int kPeopleMap = 1024, kPeopleMapOfObjects = 512;
/// Cells by which a receiver is lifted along its normal off the real things that hide the lamps:
/// the learned depth is noisy.
constexpr float kRoomLiftCells = 0.5F;
/// Without a capture volume people are looked for between these distances from the camera.
constexpr double kNearPeopleM = 0.3, kFarPeopleM = 6.0;
/// Between a lamp and the objects they are no nearer to it than this part of the way.
constexpr double kPeopleNearPart = 0.4;

/// Intensity of a lamp that a frame turns off: it keeps its maps.
constexpr float kFaintest = 1e-12F;

glm::dmat4 world_from(const VirtualObject& object) {
  glm::dmat4 m = to_glm(object.world_from_object.matrix());
  for (int column = 0; column < 3; ++column) m[column] *= object.scale;
  return m;
}

/// World to lamp axes: z from the lamp towards `target`.
glm::dmat4 lamp_from_world(const glm::dvec3& lamp, const glm::dvec3& target) {
  const glm::dvec3 z = glm::normalize(target - lamp);
  const glm::dvec3 other = std::abs(z.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(other, z));
  const glm::dvec3 y = glm::cross(z, x);
  glm::dmat4 m(1);
  for (int i = 0; i < 3; ++i) m[i] = glm::dvec4(x[i], y[i], z[i], 0);
  m[3] = glm::dvec4(-glm::dot(x, lamp), -glm::dot(y, lamp), -glm::dot(z, lamp), 1);
  return m;
}

glm::dvec3 apply(const glm::dmat4& m, const glm::dvec3& p) {
  return glm::dvec3(m * glm::dvec4(p, 1));
}

/// Corners of an object's box, in world.
void append_corners(const VirtualObject& object, std::vector<glm::dvec3>& corners) {
  glm::vec3 low(std::numeric_limits<float>::max()), high = -low;
  for (const MeshView& mesh : object.meshes)
    for (const glm::vec3& p : mesh.positions_m) low = glm::min(low, p), high = glm::max(high, p);
  if (!(low.x <= high.x)) return;
  const glm::dmat4 m = world_from(object);
  for (int i = 0; i < 8; ++i)
    corners.push_back(
        apply(m, {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}));
}

/// View pixels of a box; the whole view where it reaches behind the camera.
void include_box(std::span<const glm::dvec3> corners, const glm::dmat4& camera_from_world,
                 const geometry::Pinhole& view, Rect& rect) {
  double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
  int behind = 0;
  for (const glm::dvec3& corner : corners) {
    const glm::dvec3 p = apply(camera_from_world, corner);
    if (p.z < kNearestM) {
      ++behind;
      continue;
    }
    const Eigen::Vector2d px = view.project({p.x, p.y, p.z});
    x0 = std::min(x0, px.x()), x1 = std::max(x1, px.x());
    y0 = std::min(y0, px.y()), y1 = std::max(y1, px.y());
  }
  if (behind == static_cast<int>(corners.size())) return;
  if (behind > 0) x0 = y0 = -1e9, x1 = y1 = 1e9;
  const auto clip = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const Rect box{
      clip(std::floor(x0), view.size_px.width), clip(std::floor(y0), view.size_px.height),
      clip(std::ceil(x1) + 1, view.size_px.width), clip(std::ceil(y1) + 1, view.size_px.height)};
  if (box.empty()) return;
  if (rect.empty()) rect = box;
  rect = {std::min(rect.x0, box.x0), std::min(rect.y0, box.y0), std::max(rect.x1, box.x1),
          std::max(rect.y1, box.y1)};
}

/// Whether light is found once and stays, so that it may take longer.
bool light_stays(const CompositorSetup& setup) {
  return setup.background_models.empty() && !setup.lens_moves && !setup.people_cast_shadows;
}

std::vector<LampPart> whole_lamps(const std::vector<Lamp>& lamps) {
  std::vector<LampPart> parts;
  for (const Lamp& lamp : lamps)
    parts.push_back({lamp, static_cast<int>(&lamp - lamps.data()), false});
  return parts;
}

/// Whether people are looked for between the lamps and the objects alone.
bool people_around_objects(const CompositorSetup& setup) {
  return !setup.capture_box &&
         std::none_of(setup.objects.begin(), setup.objects.end(),
                      [](const VirtualObject& object) { return object.in_set; });
}

}  // namespace

KeyBy key_by(const CompositorSetup& setup) {
  if (!setup.background.depth_m.empty() || !setup.background_models.empty())
    return KeyBy::kBackground;
  return setup.capture_box ? KeyBy::kVolume : KeyBy::kNothing;
}

double disc_radius_m(const Lamp& lamp) { return std::sqrt(lamp.size_m.x * lamp.size_m.y / M_PI); }

std::array<glm::dvec3, 2> half_sides_m(const Lamp& lamp, const glm::dvec3& toward) {
  constexpr double kFlat = 0.9;
  const glm::dvec3 normal = glm::normalize(lamp.direction.value_or(toward));
  const glm::dvec3 along =
      std::abs(normal.z) > kFlat ? glm::dvec3(1, 0, 0) : glm::cross(glm::dvec3(0, 0, 1), normal);
  const glm::dvec3 u = glm::normalize(along - glm::dot(along, normal) * normal);
  const glm::dvec2 half_m =
      lamp.direction ? 0.5 * lamp.size_m : glm::dvec2(0.5 * std::sqrt(M_PI) * disc_radius_m(lamp));
  return {half_m.x * u, half_m.y * glm::cross(normal, u)};
}

std::vector<LampPart> parts_of_lamps(const std::vector<Lamp>& lamps) {
  const auto is_panel = [](const Lamp& lamp) { return lamp.direction && disc_radius_m(lamp) > 0; };
  const auto panels = static_cast<std::size_t>(std::count_if(lamps.begin(), lamps.end(), is_panel));
  const bool split = lamps.size() + 3 * panels <= std::size_t{kMostLamps};
  std::vector<LampPart> parts;
  for (const Lamp& lamp : lamps) {
    const int part_of = static_cast<int>(&lamp - lamps.data());
    if (!split || !is_panel(lamp)) {
      parts.push_back({lamp, part_of});
      continue;
    }
    const auto [u_m, v_m] = half_sides_m(lamp, *lamp.direction);
    for (const auto& [u, v] : {std::pair(-0.5, -0.5), {0.5, -0.5}, {-0.5, 0.5}, {0.5, 0.5}})
      parts.push_back({{lamp.position_m + u * u_m + v * v_m, lamp.direction, 0.5 * lamp.size_m,
                        0.25F * lamp.intensity},
                       part_of,
                       true});
  }
  return parts;
}

bool place_objects(std::span<const geometry::Pose> world_from_object, CompositorSetup& setup) {
  bool moved = false;
  const std::size_t count = std::min(world_from_object.size(), setup.objects.size());
  for (std::size_t i = 0; i < count; ++i) {
    geometry::Pose& pose = setup.objects[i].world_from_object;
    const geometry::Pose& next = world_from_object[i];
    if (pose.translation_m == next.translation_m &&
        pose.rotation.coeffs() == next.rotation.coeffs())
      continue;
    pose = next, moved = true;
  }
  return moved;
}

bool set_light(const std::optional<FrameLight>& light, CompositorSetup& setup) {
  if (!light) return false;
  Light& to = setup.light;
  bool changed = to.ambient != light->ambient || to.exposure != light->exposure;
  to.ambient = light->ambient, to.exposure = light->exposure;
  const std::size_t count = std::min(light->intensity.size(), to.lamps.size());
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3& intensity = to.lamps[i].intensity;
    const glm::vec3 wanted = glm::max(light->intensity[i], glm::vec3(kFaintest));
    if (intensity == glm::vec3(0) || intensity == wanted) continue;
    intensity = wanted, changed = true;
  }
  return changed;
}

/// Boxes of the objects, and the maps of the lamps around those that cast shadows.
void FramePreparer::fit_objects() {
  corners_m_.clear(), caster_corners_m_.clear(), fits_.clear();
  for (const VirtualObject& object : setup_.objects) {
    append_corners(object, corners_m_);
    if (object.casts_shadow) append_corners(object, caster_corners_m_);
  }
  for (const LampPart& part : parts_) fits_.push_back(fit_map(part.lamp, caster_corners_m_));
}

FramePreparer::FramePreparer(const CompositorSetup& setup) : setup_(setup) {
  std::size_t objects = setup.objects.size();
  for (std::size_t i = 0; i < objects; ++i)
    for (const MeshView& mesh : setup.objects[i].meshes)
      params_.draws.push_back({&mesh, static_cast<int>(i), setup.objects[i].casts_shadow, {}});
  parts_ = light_stays(setup) ? parts_of_lamps(setup.light.lamps) : whole_lamps(setup.light.lamps);
  params_.lamps.resize(parts_.size());
  params_.lamp_from_object.assign(parts_.size(), std::vector<glm::mat4>(objects));
  fit_objects();
  if (setup.people_cast_shadows && !setup.objects.empty() && key_by(setup) != KeyBy::kNothing) {
    params_.people_lamps.resize(setup.light.lamps.size());
    people_fits_.resize(setup.light.lamps.size());
  }

  for (const Draw& draw : params_.draws) {
    params_.glossy |= !draw.mesh->gloss.is_matte();
    params_.emits |= draw.mesh->emission != glm::vec3(0);
  }
  KeyPassParams& key = params_.key;
  key.color = setup.key.color;
  key.refine = setup.key.refine;
  key.crop = setup.capture_box.has_value();
  if (key.crop)
    key.crop_min_m = setup.capture_box->min_m, key.crop_max_m = setup.capture_box->max_m;
  key.by = key_by(setup);
  key.noise = noise_params(setup.noise);
  key.noise_factor = setup.key.noise_factor;
  find_contacts();
  if (setup.first_pose) find_room(*setup.first_pose);
}

/// The floor's plane, raised by its tolerance, as inverse depth along the rays of this pose.
void FramePreparer::update_floor(const glm::dmat4& world_from_camera) {
  if (params_.key.by != KeyBy::kVolume) return;
  const CaptureBox& box = *setup_.capture_box;
  const double height_m =
      world_from_camera[3].z - (box.min_m.z + static_cast<double>(box.floor_tolerance_m));
  // Seen from below the floor hides nothing that it could be told from.
  params_.key.floor_w = height_m > kNearestM
                            ? glm::vec3(-glm::dvec3(world_from_camera[0].z, world_from_camera[1].z,
                                                    world_from_camera[2].z) /
                                        height_m)
                            : glm::vec3(0);
}

/// A map of what lies between `corners_m`, a multiple of eight; none for a lamp that cannot light
/// it.
FramePreparer::MapFit FramePreparer::fit_map(const Lamp& lamp,
                                             std::span<const glm::dvec3> corners_m) const {
  MapFit fit;
  const bool dark = lamp.intensity == glm::vec3(0);
  const bool all_behind =
      lamp.direction && std::all_of(corners_m.begin(), corners_m.end(), [&](auto& p) {
        return glm::dot(p - lamp.position_m, *lamp.direction) <= 0;
      });
  if (corners_m.empty() || dark || all_behind) return fit;
  glm::dvec3 low = corners_m[0], high = low;
  for (const glm::dvec3& p : corners_m) low = glm::min(low, p), high = glm::max(high, p);
  const glm::dvec3 center = 0.5 * (low + high);
  // A lamp at the centre has no direction to it: its own is taken, or straight down.
  const bool at_center = glm::distance(center, lamp.position_m) < kNearestM;
  const glm::dvec3 fallback = lamp.direction ? *lamp.direction : glm::dvec3(0, 0, -1);
  fit.lamp_from_world =
      lamp_from_world(lamp.position_m, at_center ? lamp.position_m + fallback : center);
  fit.near_m = 1e9;
  for (const glm::dvec3& corner : corners_m) {
    const glm::dvec3 p = apply(fit.lamp_from_world, corner);
    const double tan =
        p.z > kNearestM ? std::max(std::abs(p.x), std::abs(p.y)) / p.z : kLargestTanHalf;
    fit.tan_half = std::min(kLargestTanHalf, std::max(fit.tan_half, tan));
    fit.near_m = std::max(kNearestM, std::min(fit.near_m, p.z));
  }
  return fit;
}

/// Maps of the capture volume; without one, of what lies between a lamp and the objects, or of what
/// the camera sees of a set, which is all around.
void FramePreparer::fit_people_maps(const geometry::Pose& world_from_target) {
  const bool around_objects = people_around_objects(setup_);
  const bool stay = setup_.capture_box || around_objects;
  if (params_.people_lamps.empty() || (stay && people_fits_[0].near_m > 0)) return;
  if (around_objects) {
    for (std::size_t i = 0; i < people_fits_.size(); ++i) {
      const Lamp& lamp = setup_.light.lamps[i];
      people_fits_[i] = fit_map(lamp, corners_m_);
      // The floor in the objects' penumbrae, and the filters around it.
      if (people_fits_[i].tan_half > 0)
        people_fits_[i].tan_half =
            std::min(kLargestTanHalf,
                     people_fits_[i].tan_half + disc_radius_m(lamp) / people_fits_[i].near_m);
      people_fits_[i].near_m = std::max(kNearPeopleM, kPeopleNearPart * people_fits_[i].near_m);
    }
    return;
  }
  std::array<glm::dvec3, 8> corners_m;
  for (std::size_t i = 0; i < 8; ++i) {
    if (setup_.capture_box) {
      const CaptureBox& box = *setup_.capture_box;
      corners_m[i] = {i & 1 ? box.max_m.x : box.min_m.x, i & 2 ? box.max_m.y : box.min_m.y,
                      i & 4 ? box.max_m.z : box.min_m.z};
    } else {
      const Size size = setup_.view.size_px;
      const Eigen::Vector2d ray =
          setup_.view.unproject({i & 1 ? size.width : 0.0, i & 2 ? size.height : 0.0});
      const Eigen::Vector3d p = world_from_target * (Eigen::Vector3d(ray.x(), ray.y(), 1) *
                                                     (i & 4 ? kFarPeopleM : kNearPeopleM));
      corners_m[i] = {p.x(), p.y(), p.z()};
    }
  }
  for (std::size_t i = 0; i < people_fits_.size(); ++i) {
    people_fits_[i] = fit_map(setup_.light.lamps[i], corners_m);
    people_fits_[i].near_m = std::max(people_fits_[i].near_m, kNearPeopleM);
  }
}

/// Texels across: twice as many as view pixels across the casters, as a power of two, so that a
/// moving camera seldom changes it.
int FramePreparer::map_size(const glm::dmat4& camera_from_world) const {
  Rect rect;
  include_box(caster_corners_m_, camera_from_world, setup_.view, rect);
  const int wanted = kMapTexelsPerPixel * std::max(rect.x1 - rect.x0, rect.y1 - rect.y0);
  int size = kSmallestMap;
  while (size < wanted && size < kLargestMap) size *= 2;
  return size;
}

LampParams FramePreparer::lamp_params(const Lamp& lamp, const MapFit& fit, int map_size_texel,
                                      const glm::dmat4& world_from_camera,
                                      const glm::dmat4& camera_from_world) {
  LampParams out;
  out.position_m = apply(camera_from_world, lamp.position_m);
  out.direction =
      lamp.direction ? glm::vec3(glm::dmat3(camera_from_world) * *lamp.direction) : glm::vec3(0);
  out.radius_m = static_cast<float>(disc_radius_m(lamp));
  out.intensity = lamp.intensity;
  out.map_size_texel = fit.tan_half > 0 ? map_size_texel : 0;
  if (out.map_size_texel == 0) return out;
  out.lamp_from_camera = glm::mat4(fit.lamp_from_world * world_from_camera);
  out.map_center_texel = 0.5F * static_cast<float>(map_size_texel - 1);
  if (out.radius_m > 0) {
    const glm::dmat3 turn(fit.lamp_from_world);
    const auto [u_m, v_m] = half_sides_m(lamp, glm::transpose(turn)[2]);
    out.panel_u = turn * u_m / disc_radius_m(lamp), out.panel_v = turn * v_m / disc_radius_m(lamp);
  }
  // One texel of margin, so that what lies outside the map is lit.
  out.map_focal_texel = (out.map_center_texel - 1) / static_cast<float>(fit.tan_half);
  out.casters_near_m = static_cast<float>(fit.near_m);
  return out;
}

/// A still background is where the first pose puts it. Found once: lamps, objects and room stay.
void FramePreparer::find_room(const geometry::Pose& world_from_target) {
  if (std::exchange(has_room_, true)) return;
  ambient_ = make_ambient(setup_, world_from_target), ambient_then_ = setup_.light.ambient;
  if (!needs_room_shade(setup_)) return;
  room_ = make_room_shade(setup_, world_from_target);
  params_.room_share = room_.share;
  if (room_.layer_of.empty()) return;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    params_.lamps[i].room_layer = room_.layer_of[static_cast<std::size_t>(parts_[i].part_of)];
}

void FramePreparer::update_room(const geometry::Pose& world_from_target) {
  find_room(world_from_target);
  params_.room_changed = !has_pose_ && needs_room_shade(setup_);
  if (room_.empty()) return;
  const double scale = 1 / room_.cell_m;
  glm::dmat4 cell_from_world(scale);
  cell_from_world[3] = glm::dvec4(-scale * room_.first_m, 1);
  params_.room = {glm::mat4(cell_from_world * to_glm(world_from_target.matrix())), room_.cells,
                  kRoomLiftCells * static_cast<float>(room_.cell_m)};
}

/// Found once, with the room's shade; later it is as much brighter as the constant part is.
void FramePreparer::update_ambient(const geometry::Pose& world_from_target) {
  LightParams& light = params_.light;
  light.ambient = setup_.light.ambient, light.exposure = setup_.light.exposure;
  light.world_from_camera = glm::mat3(to_glm(world_from_target.matrix()));
  light.by_direction = ambient_.has_value();
  if (!ambient_) return;
  glm::vec3 brighter(1);
  for (int c = 0; c < 3; ++c)
    if (ambient_then_[c] > 0) brighter[c] = light.ambient[c] / ambient_then_[c];
  for (std::size_t i = 0; i < ambient_->size(); ++i)
    light.ambient_terms[i] = brighter * (*ambient_)[i];
}

void FramePreparer::update_lamps(const glm::dmat4& world_from_camera,
                                 const glm::dmat4& camera_from_world) {
  const int wanted = caster_corners_m_.empty() ? 0 : map_size(camera_from_world);
  params_.maps_changed = wanted != map_size_;
  map_size_ = wanted;
  for (std::size_t i = 0; i < params_.lamps.size(); ++i) {
    const MapFit& fit = fits_[i];
    const int room_layer = params_.lamps[i].room_layer;
    const int size = parts_[i].is_part ? std::min(map_size_, kLargestPartMap) : map_size_;
    params_.lamps[i] = lamp_params(parts_[i].lamp, fit, size, world_from_camera, camera_from_world);
    params_.lamps[i].room_layer = room_layer;
    params_.lamps[i].part_of = parts_[i].part_of, params_.lamps[i].is_part = parts_[i].is_part;
    if (params_.lamps[i].map_size_texel == 0) continue;
    for (std::size_t k = 0; k < setup_.objects.size(); ++k)
      params_.lamp_from_object[i][k] =
          glm::mat4(fit.lamp_from_world * world_from(setup_.objects[k]));
  }
  const int people_map = people_around_objects(setup_) ? kPeopleMapOfObjects : kPeopleMap;
  for (std::size_t i = 0; i < params_.people_lamps.size(); ++i)
    params_.people_lamps[i] = lamp_params(setup_.light.lamps[i], people_fits_[i], people_map,
                                          world_from_camera, camera_from_world);
}

void FramePreparer::update(const geometry::Pose& world_from_target, bool view_changed,
                           bool objects_moved, bool light_changed) {
  params_.pose_changed = !has_pose_ || view_changed || objects_moved || light_changed ||
                         world_from_target.rotation.coeffs() != last_pose_.rotation.coeffs() ||
                         world_from_target.translation_m != last_pose_.translation_m;
  params_.maps_changed = params_.room_changed = false;
  if (!params_.pose_changed) return;
  // Lamps of which there are parts are whole once an object has moved.
  const bool split = parts_.size() > setup_.light.lamps.size();
  if (light_changed && split) parts_ = parts_of_lamps(setup_.light.lamps);
  if ((light_changed && !split) || (objects_moved && split)) {
    parts_ = whole_lamps(setup_.light.lamps);
    params_.lamps.resize(parts_.size());
    for (std::size_t i = 0; i < room_.layer_of.size(); ++i)
      params_.lamps[i].room_layer = room_.layer_of[i];
  }
  if (objects_moved) {
    fit_objects();
    map_size_ = 0;  // they are drawn again
    if (!people_fits_.empty() && people_around_objects(setup_)) people_fits_[0].near_m = 0;
  }
  update_room(world_from_target);
  update_ambient(world_from_target);
  update_contacts(world_from_target);
  has_pose_ = true;
  last_pose_ = world_from_target;
  const glm::dmat4 world_from_camera = to_glm(world_from_target.matrix());
  const glm::dmat4 camera_from_world = to_glm(geometry::inverse(world_from_target).matrix());
  params_.key.world_from_camera = glm::mat4(world_from_camera);
  update_floor(world_from_camera);
  fit_people_maps(world_from_target);
  update_lamps(world_from_camera, camera_from_world);

  for (Draw& draw : params_.draws) {
    const VirtualObject& object = setup_.objects[static_cast<std::size_t>(draw.object)];
    const glm::dmat4 camera_from_object = camera_from_world * world_from(object);
    draw.params.camera_from_object = glm::mat4(camera_from_object);
    draw.params.camera_from_object_normal =
        glm::mat3(camera_from_object) / static_cast<float>(object.scale);
    draw.params.base_color = draw.mesh->base_color;
    draw.params.view = {glm::vec2(setup_.view.fx_px, setup_.view.fy_px),
                        glm::vec2(setup_.view.cx_px, setup_.view.cy_px)};
  }
  params_.virtual_rect = {};
  double nearest_m = kFarthestM;
  for (const glm::dvec3& corner_m : corners_m_)
    nearest_m = std::min(nearest_m, (camera_from_world * glm::dvec4(corner_m, 1)).z);
  params_.nearest_virtual_w =
      static_cast<float>(1 / std::max(nearest_m, static_cast<double>(kNearestM)));
  for (std::size_t first = 0; first + 8 <= corners_m_.size(); first += 8)
    include_box(std::span(corners_m_).subspan(first, 8), camera_from_world, setup_.view,
                params_.virtual_rect);
}

}  // namespace mixrig::render
