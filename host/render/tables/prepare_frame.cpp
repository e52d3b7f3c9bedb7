// SPDX-License-Identifier: Apache-2.0
// Transforms of a frame: brings the virtual objects, the room and its light into camera axes.
#include <algorithm>
#include <utility>

#include "host/render/tables/prepare_axes.h"

namespace mixrig::render {
namespace {

/// Cells by which a receiver is moved along its normal off the real things that hide lamps: the
/// learned depth is noisy.
constexpr float kRoomLiftCells = 0.5F;
/// Intensity of a lamp that a frame turns off; not 0, so that it keeps its maps.
constexpr float kFaintest = 1e-12F;

/// Whether light is computed once and kept, except for what people hide, so that it may take
/// longer.
bool light_stays(const CompositorSetup& setup) {
  return setup.background_models.empty() && !setup.lens_moves;
}

/// Edges are softened by a pixel past those that objects touch.
Rect with_soft_edges(const Rect& r, Size view) {
  if (r.empty()) return r;
  return {std::max(r.x0 - 1, 0), std::max(r.y0 - 1, 0), std::min(r.x1 + 1, view.width),
          std::min(r.y1 + 1, view.height)};
}

}  // namespace

KeyBy key_by(const CompositorSetup& setup) {
  if (!setup.background.depth_m.empty() || !setup.background_models.empty())
    return KeyBy::kBackground;
  return setup.capture_box ? KeyBy::kVolume : KeyBy::kNothing;
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
  geometry::Light& to = setup.light;
  const Eigen::Vector3f ambient = to_eigen(light->ambient);
  bool changed = to.ambient != ambient || static_cast<float>(to.exposure) != light->exposure;
  to.ambient = ambient, to.exposure = light->exposure;
  const std::size_t count = std::min(light->intensity.size(), to.lamps.size());
  for (std::size_t i = 0; i < count; ++i) {
    geometry::Lamp& lamp = to.lamps[i];
    const Eigen::Vector3f wanted = to_eigen(light->intensity[i]).cwiseMax(kFaintest);
    if (lamp.is_dark() || lamp.intensity == wanted) continue;
    lamp.intensity = wanted, changed = true;
  }
  return changed;
}

FramePreparer::FramePreparer(const CompositorSetup& setup) : setup_(setup) {
  std::size_t objects = setup.objects.size();
  for (std::size_t i = 0; i < objects; ++i)
    for (const MeshView& mesh : setup.objects[i].meshes)
      params_.draws.push_back({&mesh, static_cast<int>(i), setup.objects[i].casts_shadow, {}});
  parts_ = light_stays(setup) ? parts_of_lamps(setup.light.lamps) : whole_lamps(setup.light.lamps);
  params_.lamps.resize(parts_.size());
  params_.lamp_from_object.assign(parts_.size(), std::vector<glm::mat4>(objects));
  if (setup.people_cast_shadows && !setup.objects.empty() && key_by(setup) != KeyBy::kNothing) {
    params_.people_lamps.resize(setup.light.lamps.size());
    people_fits_.resize(setup.light.lamps.size());
  }
  fit_objects();

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

/// Sets the floor's plane, raised by its tolerance, as inverse depth along the rays of this pose.
void FramePreparer::update_floor(const glm::dmat4& world_from_camera) {
  if (params_.key.by != KeyBy::kVolume) return;
  const CaptureBox& box = *setup_.capture_box;
  const double height_m =
      world_from_camera[3].z - (box.min_m.z + static_cast<double>(box.floor_tolerance_m));
  // From below, nothing can be told from the floor.
  params_.key.floor_w = height_m > kNearestM
                            ? glm::vec3(-glm::dvec3(world_from_camera[0].z, world_from_camera[1].z,
                                                    world_from_camera[2].z) /
                                        height_m)
                            : glm::vec3(0);
}

/// Finds what the room hides of lamps and its ambient light, once: lamps, objects and room stay. A
/// still background is placed by the first pose.
void FramePreparer::find_room(const geometry::Pose& world_from_target) {
  if (std::exchange(has_room_, true)) return;
  ambient_ = make_ambient(setup_, world_from_target), ambient_then_ = to_glm(setup_.light.ambient);
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
  params_.room =
      grid_params(room_.first_m, room_.cell_m, room_.cells, to_glm(world_from_target.matrix()));
  params_.room.lift_m = kRoomLiftCells * static_cast<float>(room_.cell_m);
}

/// Scales the ambient light by direction, found once, as the setup's constant ambient light
/// changes.
void FramePreparer::update_ambient(const geometry::Pose& world_from_target) {
  LightParams& light = params_.light;
  light.ambient = to_glm(setup_.light.ambient);
  light.exposure = static_cast<float>(setup_.light.exposure);
  light.world_from_camera = glm::mat3(to_glm(world_from_target.matrix()));
  light.by_direction = ambient_.has_value();
  if (!ambient_) return;
  glm::vec3 brighter(1);
  for (int c = 0; c < 3; ++c)
    if (ambient_then_[c] > 0) brighter[c] = light.ambient[c] / ambient_then_[c];
  for (std::size_t i = 0; i < ambient_->size(); ++i)
    light.ambient_terms[i] = brighter * (*ambient_)[i];
}

void FramePreparer::note(const SetupChanges& changes) {
  noted_ = {noted_.view || changes.view, noted_.objects || changes.objects,
            noted_.light || changes.light};
}

void FramePreparer::update(const geometry::Pose& world_from_target, const SetupChanges& changes) {
  note(changes);
  const auto [view_changed, objects_moved, light_changed] = std::exchange(noted_, {});
  params_.pose_changed = !has_pose_ || view_changed || objects_moved || light_changed ||
                         world_from_target.rotation.coeffs() != last_pose_.rotation.coeffs() ||
                         world_from_target.translation_m != last_pose_.translation_m;
  params_.maps_changed = params_.room_changed = false;
  if (!params_.pose_changed) return;
  // Panels become whole lamps once an object has moved.
  const bool split = parts_.size() > setup_.light.lamps.size();
  if (light_changed && split) parts_ = parts_of_lamps(setup_.light.lamps);
  if ((light_changed && !split) || (objects_moved && split)) {
    parts_ = whole_lamps(setup_.light.lamps);
    params_.lamps.resize(parts_.size());
    for (std::size_t i = 0; i < room_.layer_of.size(); ++i)
      params_.lamps[i].room_layer = room_.layer_of[i];
  }
  if (objects_moved) fit_objects();
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
  params_.virtual_rect = with_soft_edges(params_.virtual_rect, setup_.view.size_px);
}

}  // namespace mixrig::render
