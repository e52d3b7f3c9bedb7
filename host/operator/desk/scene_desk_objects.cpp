// SPDX-License-Identifier: Apache-2.0
// Objects that the scene desk adds, copies and removes.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/math/config/writer.h"
#include "host/operator/desk/desk_lookup.h"
#include "host/operator/desk/fitted_model.h"
#include "host/operator/desk/place.h"
#include "host/operator/desk/scene_desk.h"
#include "host/scene/scene_edit.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// "models/NAME.glb" that is free beside the scene; bytes that are no letters become '_'.
fs::path free_model_path(const fs::path& folder, const std::string& name) {
  std::string plain;
  for (const char c : name) plain += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  for (int i = 1;; ++i) {
    const fs::path path =
        fs::path("models") / (plain + (i > 1 ? "_" + std::to_string(i) : "") + ".glb");
    if (!fs::exists(folder / path)) return path;
  }
}

/// Most bytes of models beside a scene, with what is sent next.
constexpr std::uintmax_t kMostModels = std::uintmax_t{1} << 30;

/// Refuses a model that would fill the disk, sent again and again.
Result<void> check_room(const fs::path& models, const fs::path& next) {
  std::error_code ignored;
  std::uintmax_t bytes = fs::file_size(next, ignored);
  for (const fs::directory_entry& entry : fs::directory_iterator(models, ignored))
    if (const std::uintmax_t size = entry.file_size(ignored); !ignored) bytes += size;
  if (bytes <= kMostModels) return {};
  return Error{ErrorCode::kData, "'" + models.string() +
                                     "' would have more than 1 GiB of models: remove those that "
                                     "no scene uses"};
}

/// "crate 2", or the next number that no object has; the number of "crate 2" itself is replaced.
std::string free_object_name(const scene::Scene& scene, std::string name) {
  const auto digits = name.find_last_not_of("0123456789");
  if (digits != std::string::npos && digits + 1 < name.size() && name[digits] == ' ')
    name.resize(digits);
  for (int i = 2;; ++i) {
    const std::string wanted = name + " " + std::to_string(i);
    if (std::none_of(scene.objects.begin(), scene.objects.end(),
                     [&](const scene::Object& o) { return o.name == wanted; }))
      return wanted;
  }
}

/// What is wrong with a model that was sent, without the path of its temporary file.
Error model_fault(const std::string& name, const Error& error) {
  const auto quote = error.context.find("': ");
  const std::string why =
      quote == std::string::npos ? error.context : error.context.substr(quote + 3);
  const bool says_what_to_do = why.find(": ") != std::string::npos;
  if (error.code == ErrorCode::kIo) return {error.code, "the model \"" + name + "\": " + why};
  return {error.code, "the model \"" + name + "\" " +
                          (says_what_to_do ? why
                                           : "is damaged (" + why +
                                                 "): export it again as glTF 2.0, with the "
                                                 "ending .glb")};
}

/// The empty floor where a new object stands: the lower middle of the picture, so that it is before
/// people; without a floor there, 2 m ahead.
Vector3d place_before(const SeenFrom& from) {
  constexpr double kFarthest_m = 6, kAhead_m = 2;
  const Vector3d& eye = from.world_from_view.translation_m;
  for (const double v : {0.8, 0.9, 0.97})
    if (const auto floor = point_on_level(from, {0.5, v}, 0);
        floor && (*floor - eye).norm() < kFarthest_m)
      return *floor;
  return from.world_from_view * Vector3d(0, 0, kAhead_m);
}

}  // namespace

Result<void> SceneDesk::apply(const page::AddObject& add, const SeenFrom* from) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const SeenFrom* used, seen(from));
  scene::Object object;
  object.name = add.name;
  auto model = scene::load_gltf(add.glb);
  if (!model) return model_fault(add.name, model.error());
  object.model = *std::move(model);
  const fs::path folder = session_.scene.path.parent_path();
  MIXRIG_TRY(check_room(folder / "models", add.glb));
  object.model_path = free_model_path(folder, add.name);
  fit(object, *used, place_before(*used));
  MIXRIG_ASSIGN(const Written now, written());
  MIXRIG_ASSIGN(const std::string text, with_poses(now.text, ""));
  std::error_code code;
  fs::create_directories(folder / "models", code);
  if (!code) fs::copy_file(add.glb, folder / object.model_path, code);
  if (code)
    return system_error(ErrorCode::kIo,
                        "cannot write '" + (folder / object.model_path).string() + "'",
                        code.value());
  auto edited = scene::with_new_object(text, session_.scene.path, object);
  Result<void> done = edited ? put(now, *edited, "add " + add.name) : edited.error();
  if (!done) fs::remove(folder / object.model_path, code);
  if (done && object.scale != 1)
    log_info("page", fmt::format("\"{}\" is {:.3g} m large: it was added at scale {:g}, {:.2g} m",
                                 add.name, largest_m(object.model), object.scale,
                                 object.scale * largest_m(object.model)));
  return done;
}

/// The copy stands beside the object, to the right as the camera sees it.
Result<void> SceneDesk::apply(const page::CopyObject& copy, const SeenFrom* from) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  MIXRIG_ASSIGN(const std::string text, with_poses(now.text, ""));
  MIXRIG_ASSIGN(const scene::Scene scene, scene::parse_scene(text, session_.scene.path, false));
  MIXRIG_ASSIGN(const scene::Object* object, named(scene.objects, copy.name, "object"));
  double width_m = 0.5;
  const EditedScenePtr newest = follower_->newest();
  if (const auto modelled = named(shown_scene(newest).objects, copy.name, "object");
      modelled && !(*modelled)->model.meshes.empty())
    width_m = object->scale * largest_m((*modelled)->model);
  Vector3d right = from != nullptr ? Vector3d(from->world_from_view.rotation * Vector3d::UnitX())
                                   : Vector3d(Vector3d::UnitX());
  right.z() = 0;
  geometry::Pose pose = object->world_from_object;
  pose.translation_m += (width_m + 0.05) * right.normalized();
  const std::string name = free_object_name(scene, copy.name);
  MIXRIG_ASSIGN(const std::string edited,
                scene::with_object_copy(text, session_.scene.path, copy.name, name, pose));
  return put(now, edited, "copy " + copy.name);
}

Result<void> SceneDesk::apply(const page::RemoveObject& remove) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  const auto found = named(now.scene.objects, remove.name, "object");
  if (!found) return found.error();
  MIXRIG_ASSIGN(std::string text, with_poses(now.text, remove.name));
  MIXRIG_ASSIGN(text, scene::without_object(text, session_.scene.path, remove.name));
  MIXRIG_TRY(put(now, text, "remove " + remove.name));
  forget_preview(remove.name);
  return {};
}

}  // namespace mixrig::session
