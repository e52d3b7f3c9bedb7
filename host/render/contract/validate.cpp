// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "host/render/contract/compositor.h"
#include "host/render/contract/constants.h"

namespace mixrig::render {
namespace {

Error bad(const std::string& what) { return {ErrorCode::kData, "compositor: " + what}; }

std::string text(Size size) { return fmt::format("{} x {}", size.width, size.height); }

bool finite(const geometry::Pose& pose) {
  return pose.rotation.coeffs().allFinite() && pose.translation_m.allFinite() &&
         std::abs(pose.rotation.norm() - 1) < 1e-3;
}
bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool is_color(const Eigen::Vector3f& c) {
  return c.allFinite() && c.x() >= 0 && c.y() >= 0 && c.z() >= 0;
}

template <typename T>
Result<void> same_size(const ImageView<T>& image, Size view, const char* name) {
  if (image.empty() || image.size == view) return {};
  return bad(fmt::format("background {} is {}, the view {}: learn the background in this view",
                         name, text(image.size), text(view)));
}

Result<void> check_background(const BackgroundView& background, Size view) {
  MIXRIG_TRY(same_size(background.depth_m, view, "depth"));
  MIXRIG_TRY(same_size(background.depth_sigma_m, view, "depth spread"));
  MIXRIG_TRY(same_size(background.color, view, "colour"));
  MIXRIG_TRY(same_size(background.color_sigma, view, "colour spread"));
  if (background.depth_m.empty() && !background.color.empty())
    return bad("the background has colour but no depth: learn it again");
  return {};
}

Result<void> check_background_model(const BackgroundModel& model) {
  if (model.depth_m.empty()) return bad("the background model has no depth: learn it again");
  const std::size_t faces = model.world_from_face.size();
  if (faces < 1 || faces > static_cast<std::size_t>(kMostFaces))
    return bad(fmt::format("the background model has {} faces, it may have 1 to {}: learn it again",
                           faces, kMostFaces));
  const bool placed = std::all_of(model.world_from_face.begin(), model.world_from_face.end(),
                                  [](const geometry::Pose& pose) { return finite(pose); });
  if (!(model.camera.fx_px > 0) || !(model.camera.fy_px > 0) || !placed)
    return bad("the background model has a camera or pose that is not finite: learn it again");
  if (model.color_factor < 1 || model.color_factor > kMostColorFactor)
    return bad(
        fmt::format("the colour of the background model is {} times as large as its depth, "
                    "it may be 1 to {} times: learn it again",
                    model.color_factor, kMostColorFactor));
  const Size face = model.camera.size_px;
  const Size images{face.width, face.height * static_cast<int>(faces)};
  MIXRIG_TRY(same_size(model.depth_m, images, "depth"));
  MIXRIG_TRY(same_size(model.depth_sigma_m, images, "depth spread"));
  const int factor = model.color_factor;
  return same_size(model.color, {factor * images.width, factor * images.height}, "colour");
}

Result<void> check_background_models(const CompositorSetup& setup) {
  const std::vector<BackgroundModel>& models = setup.background_models;
  if (models.empty()) return {};
  if (!setup.background.depth_m.empty())
    return bad("there are two backgrounds, a still one and a model: give one of them");
  if (models.size() > static_cast<std::size_t>(kMostModels))
    return bad(fmt::format("there are {} background models, there may be {}: leave some out",
                           models.size(), kMostModels));
  for (const BackgroundModel& model : models) MIXRIG_TRY(check_background_model(model));
  return {};
}

Result<void> check_backdrop(const CompositorSetup& setup) {
  if (!setup.backdrop) return {};
  if (setup.background.depth_m.empty() && setup.background_models.empty() && !setup.capture_box)
    return bad(
        "the background is replaced but nothing tells people from it: give a capture volume "
        "or a background");
  const ImageView<const Rgb8>& picture = setup.backdrop->picture;
  if (picture.empty() || picture.size == setup.view.size_px) return {};
  return bad(fmt::format("the backdrop is {}, the view {}: resize it", text(picture.size),
                         text(setup.view.size_px)));
}

Result<void> check_mesh(const MeshView& mesh, const std::string& where) {
  const std::size_t n = mesh.positions_m.size();
  if (mesh.normals.size() != n) return bad(where + " does not have one normal a vertex");
  if (!mesh.uv.empty() && mesh.uv.size() != n) return bad(where + " does not have one uv a vertex");
  if (mesh.indices.size() % 3 != 0) return bad(where + " has indices that do not form triangles");
  for (const std::uint32_t index : mesh.indices)
    if (index >= n) return bad(where + " has an index past its vertices");
  for (const glm::vec3& p : mesh.positions_m)
    if (!finite(glm::dvec3(p))) return bad(where + " has a vertex that is not finite");
  return {};
}

Result<void> check_objects(const std::vector<VirtualObject>& objects) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::string where = fmt::format("object {}", i + 1);
    if (!finite(objects[i].world_from_object)) return bad(where + " has a pose that is not rigid");
    if (!(objects[i].scale > 0) || !std::isfinite(objects[i].scale))
      return bad(where + " has a scale that is not positive");
    for (const MeshView& mesh : objects[i].meshes) MIXRIG_TRY(check_mesh(mesh, where));
  }
  return {};
}

Result<void> check_light(const geometry::Light& light) {
  if (!is_color(light.ambient)) return bad("ambient light is negative or not finite");
  if (!(light.exposure > 0) || !std::isfinite(light.exposure))
    return bad("exposure is not positive");
  for (std::size_t i = 0; i < light.lamps.size(); ++i) {
    const geometry::Lamp& lamp = light.lamps[i];
    const std::string where = fmt::format("lamp {}", i + 1);
    if (!lamp.position_m.allFinite()) return bad(where + " has a position that is not finite");
    if (lamp.direction &&
        !(lamp.direction->allFinite() && std::abs(lamp.direction->norm() - 1) < 1e-3))
      return bad(where + " has a direction whose length is not 1");
    if (!(lamp.size_m.x() >= 0 && lamp.size_m.y() >= 0 && std::isfinite(lamp.size_m.sum())))
      return bad(where + " has a negative size");
    if (!is_color(lamp.intensity)) return bad(where + " has a negative intensity");
  }
  return {};
}

Result<void> check_noise(const geometry::DepthNoise& n) {
  if (n.floor_m >= 0 && n.linear >= 0 && n.quadratic_per_m >= 0 &&
      std::isfinite(n.floor_m + n.linear + n.quadratic_per_m))
    return {};
  return bad("depth noise is negative or not finite");
}

Result<void> check_focus(const CompositorSetup& setup) {
  if (!setup.focus) return {};
  const Focus& focus = *setup.focus;
  const Size view = setup.view.size_px;
  if (!(focus.aperture_m > 0) || !(focus.most_blur_px > 0) ||
      !(focus.most_blur_px <= kMostBlur_px) || !(focus.distance_m >= 0))
    return bad("the focus has an aperture, blur or distance out of range");
  if (focus.distance_m == 0 && (!focus.pixel || focus.pixel->x < 0 || focus.pixel->y < 0 ||
                                focus.pixel->x >= view.width || focus.pixel->y >= view.height))
    return bad("focus.pixel lies outside the view of " + text(view));
  return {};
}

}  // namespace

std::string_view name(Stage stage) {
  constexpr std::array<std::string_view, static_cast<std::size_t>(Stage::kCount)> kNames = {
      "upload", "plate", "correct", "warp", "background", "virtual",
      "shadow", "key",   "light",   "mix",  "focus",      "readback"};
  return kNames[static_cast<std::size_t>(stage)];
}

Result<void> validate(const CompositorSetup& setup) {
  MIXRIG_TRY(check_focus(setup));
  MIXRIG_TRY(geometry::validate(setup.target));
  MIXRIG_TRY(geometry::validate(setup.tof));
  MIXRIG_TRY(geometry::validate(geometry::CameraModel{setup.view, {}}));
  if (!finite(setup.target_from_tof)) return bad("target_from_tof is not a rigid transform");
  MIXRIG_TRY(check_noise(setup.noise));
  if (setup.tof2) {
    MIXRIG_TRY(geometry::validate(setup.tof2->model));
    MIXRIG_TRY(check_noise(setup.tof2->noise));
    if (!finite(setup.tof2->target_from_tof))
      return bad("the second depth camera's target_from_tof is not a rigid transform");
  }
  if (!(setup.key.threshold_m >= 0) || !(setup.key.noise_factor >= 0))
    return bad("key threshold or noise factor is negative");
  if (setup.capture_box &&
      !(glm::all(glm::lessThan(setup.capture_box->min_m, setup.capture_box->max_m))))
    return bad("capture volume is empty: its min must be below its max");
  if (setup.capture_box && !(setup.capture_box->floor_tolerance_m >= 0 &&
                             std::isfinite(setup.capture_box->floor_tolerance_m)))
    return bad("the floor's tolerance is negative or not finite");
  MIXRIG_TRY(check_background(setup.background, setup.view.size_px));
  if (setup.lens_moves && !setup.background.depth_m.empty())
    return bad("a still background is of one lens, but the lens moves: give it as a model");
  MIXRIG_TRY(check_background_models(setup));
  MIXRIG_TRY(check_backdrop(setup));
  MIXRIG_TRY(check_objects(setup.objects));
  return check_light(setup.light);
}

}  // namespace mixrig::render
