// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/scene_setup.h"

#include <algorithm>

#include "host/render/contract/to_glm.h"

namespace mixrig::session {
namespace {

using render::to_glm;

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
  const auto picture = [&](int index) -> ImageView<const Rgb8> {
    if (index < 0) return {};
    return model.textures[static_cast<std::size_t>(index)];
  };
  view.texture = picture(mesh.texture);
  view.gloss = {mesh.metallic, mesh.roughness, mesh.specular};
  view.emission = to_glm(mesh.emission);
  view.gloss_map = picture(mesh.gloss_map), view.normal_map = picture(mesh.normal_map);
  view.emission_map = picture(mesh.emission_map), view.normal_scale = mesh.normal_scale;
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

void set_objects(const scene::Scene& scene, const std::vector<MeshArrays>& meshes, bool shadows,
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
    out.casts_shadow = object->casts_shadow && shadows;
    out.in_set = scene.set && scene.set->model && object == &scene.set->model.value();
    setup.objects.push_back(std::move(out));
  }
}

/// The image distance of the lens is that of the view's focal length on the sensor.
void set_focus(const scene::Scene& scene, bool fast, render::CompositorSetup& setup) {
  setup.focus.reset();
  if (!scene.focus) return;
  const scene::FocusSettings& wanted = *scene.focus;
  const double width_px = setup.view.size_px.width;
  const double image_m = 1e-3 * wanted.sensor_width_mm * setup.view.fx_px / width_px;
  render::Focus focus;
  // The image distance of a lens focused at infinity is its focal length.
  const double focal_m =
      wanted.distance_m > 0 ? 1 / (1 / image_m + 1 / wanted.distance_m) : image_m;
  focus.aperture_m = static_cast<float>(focal_m / wanted.f_number);
  focus.distance_m = static_cast<float>(wanted.distance_m);
  if (wanted.pixel) focus.pixel = {wanted.pixel->first, wanted.pixel->second};
  focus.most_blur_px =
      std::min(render::kMostBlur_px, static_cast<float>(0.01 * wanted.most_blur_pct * width_px));
  focus.fast = fast;
  setup.focus = focus;
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
  const scene::Rungs rungs = scene::rungs_of(scene);
  set_objects(scene, meshes, rungs.light != scene::LightRung::kPlain, setup);
  set_focus(scene, rungs.focus == scene::FocusRung::kFast, setup);
  setup.light = scene.light;
  setup.open_walls = scene.background.open_walls;
  setup.people_cast_shadows = rungs.light == scene::LightRung::kPeople;
  const scene::LookSettings& look = scene.look;
  setup.look = {look.grain, look.blur, look.chroma, look.sharpening, look.motion};
  setup.key.threshold_m = static_cast<float>(scene.key.threshold_m);
  setup.key.noise_factor = static_cast<float>(scene.key.noise_factor);
  setup.key.color = rungs.key != scene::KeyRung::kPlain;
  setup.key.refine = rungs.key == scene::KeyRung::kRefined;
  setup.key.steady = scene.key.steady;
  if (const auto& volume = scene.capture_volume)
    setup.capture_box = {to_glm(volume->min_m), to_glm(volume->max_m),
                         static_cast<float>(volume->floor_tolerance_m)};
}

}  // namespace mixrig::session
