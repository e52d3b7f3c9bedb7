// SPDX-License-Identifier: Apache-2.0
#include "host/session/scene_setup.h"

namespace mixrig::session {
namespace {

glm::vec3 to_glm(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }
glm::dvec3 to_glm(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

MeshArrays arrays_of(const scene::Mesh& mesh) {
  MeshArrays arrays;
  for (const auto& p : mesh.positions_m) arrays.positions_m.push_back(to_glm(p));
  for (const auto& n : mesh.normals) arrays.normals.push_back(to_glm(n));
  for (const auto& t : mesh.uv) arrays.uv.emplace_back(t.x(), t.y());
  return arrays;
}

render::MeshView mesh_view(const scene::Mesh& mesh, const scene::Model& model,
                           const MeshArrays& arrays) {
  render::MeshView view;
  view.positions_m = arrays.positions_m;
  view.normals = arrays.normals;
  view.uv = arrays.uv;
  view.indices = mesh.indices;
  view.base_color = to_glm(mesh.base_color);
  if (mesh.texture >= 0) view.texture = model.textures[static_cast<std::size_t>(mesh.texture)];
  view.double_sided = mesh.double_sided;
  return view;
}

/// The scene's objects, and the set's model.
std::vector<const scene::Object*> objects_of(const scene::Scene& scene) {
  std::vector<const scene::Object*> objects;
  for (const scene::Object& object : scene.objects) objects.push_back(&object);
  if (scene.set && scene.set->model) objects.push_back(&*scene.set->model);
  return objects;
}

void set_objects(const scene::Scene& scene, const std::vector<MeshArrays>& meshes,
                 render::CompositorSetup& setup) {
  setup.objects.clear();
  auto arrays = meshes.begin();
  for (const scene::Object* object : objects_of(scene)) {
    render::VirtualObject out;
    for (const scene::Mesh& mesh : object->model.meshes) {
      if (!object->hidden) out.meshes.push_back(mesh_view(mesh, object->model, *arrays));
      ++arrays;
    }
    out.world_from_object = object->world_from_object;
    out.scale = object->scale;
    out.casts_shadow = object->casts_shadow;
    out.in_set = scene.set && scene.set->model && object == &scene.set->model.value();
    setup.objects.push_back(std::move(out));
  }
}

render::Light light_of(const scene::Light& light) {
  render::Light out{to_glm(light.ambient), static_cast<float>(light.exposure), {}};
  for (const scene::Lamp& lamp : light.lamps) {
    render::Lamp& added = out.lamps.emplace_back();
    added.position_m = to_glm(lamp.position_m);
    if (lamp.direction) added.direction = to_glm(*lamp.direction);
    added.size_m = {lamp.size_m.x(), lamp.size_m.y()};
    added.intensity = to_glm(lamp.intensity);
  }
  return out;
}

}  // namespace

std::vector<MeshArrays> mesh_arrays(const scene::Scene& scene) {
  std::vector<MeshArrays> meshes;
  for (const scene::Object* object : objects_of(scene))
    for (const scene::Mesh& mesh : object->model.meshes) meshes.push_back(arrays_of(mesh));
  return meshes;
}

void set_scene(const scene::Scene& scene, const std::vector<MeshArrays>& meshes,
               render::CompositorSetup& setup) {
  set_objects(scene, meshes, setup);
  setup.light = light_of(scene.light);
  setup.open_walls = scene.background.open_walls;
  setup.people_cast_shadows = scene.set ? scene.set->model.has_value() : scene.light.people_cast;
  setup.key.threshold_m = static_cast<float>(scene.key.threshold_m);
  setup.key.noise_factor = static_cast<float>(scene.key.noise_factor);
  setup.key.color = scene.key.color;
  setup.key.refine = scene.key.refine;
  if (const auto& volume = scene.capture_volume)
    setup.capture_box = {to_glm(volume->min_m), to_glm(volume->max_m),
                         static_cast<float>(volume->floor_tolerance_m)};
}

}  // namespace mixrig::session
