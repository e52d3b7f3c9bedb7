// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/scene_desk.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "hal/base/partial_path.h"
#include "host/math/config/table.h"
#include "host/operator/desk/desk_lookup.h"
#include "host/operator/desk/place.h"
#include "host/scene/scene_edit.h"
#include "host/scene/scene_manifest.h"
#include "host/scene/settings_edit.h"

namespace mixrig::session {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr std::size_t kMostSceneBytes = std::size_t{1} << 20;

double turn_of(const geometry::Pose& pose) {
  const Vector3d x = pose.rotation * Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

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

}  // namespace

SceneDesk::SceneDesk(const Session& session, std::shared_ptr<SceneFollower> follower)
    : session_(session), follower_(std::move(follower)) {}

const scene::Scene& SceneDesk::shown_scene(const EditedScenePtr& newest) const {
  return newest ? newest->scene : session_.scene;
}

/// Current previews; none where they belong to an older version of the scene, since the follower
/// has dropped those.
SceneDesk::Previews SceneDesk::previews() const {
  const EditedScenePtr now = follower_->newest();
  const std::lock_guard lock(mutex_);
  return previews_.of == now ? previews_ : Previews{now, {}, {}};
}

/// Precondition: mutex_ is held.
SceneDesk::Previews& SceneDesk::previews_of_now() {
  const EditedScenePtr now = follower_->newest();
  if (previews_.of != now) previews_ = {now, {}, {}};
  return previews_;
}

Result<SceneDesk::Written> SceneDesk::written() const {
  Written written;
  MIXRIG_ASSIGN(written.text, config::read_text(session_.scene.path, kMostSceneBytes));
  MIXRIG_ASSIGN(written.scene, scene::parse_scene(written.text, session_.scene.path, false));
  return written;
}

Result<std::string> SceneDesk::with_poses(std::string text, const std::string& but_object) const {
  const Previews shown = previews();
  for (const auto& [name, pose] : shown.poses) {
    if (name == but_object) continue;
    MIXRIG_ASSIGN(text, scene::with_object(text, session_.scene.path, name,
                                           {pose, std::nullopt, std::nullopt}));
  }
  return text;
}

Result<geometry::Pose> SceneDesk::wanted_pose(const scene::Object& object,
                                              const page::SetObject& set,
                                              const SeenFrom* from) const {
  const Previews shown = previews();
  const auto preview = shown.poses.find(object.name);
  geometry::Pose pose = preview != shown.poses.end() ? preview->second : object.world_from_object;
  if (set.onto) {
    MIXRIG_ASSIGN(const SeenFrom* used, seen(from));
    const EditedScenePtr newest = follower_->newest();
    MIXRIG_ASSIGN(const scene::Object* modelled,  // which has its model
                  named(shown_scene(newest).objects, set.name, "object"));
    MIXRIG_ASSIGN(const model::ClickedPlane plane, plane_on_room(session_, *used, *set.onto));
    return pose_on_plane(*modelled, plane, used->world_from_view, set.turn_rad.value_or(0), {0, 0});
  }
  if (set.position_m) pose.translation_m = *set.position_m;
  if (set.at) {
    MIXRIG_ASSIGN(const SeenFrom* used, seen(from));
    MIXRIG_ASSIGN(pose.translation_m, point_on_level(*used, *set.at, pose.translation_m.z()));
  }
  if (set.turn_rad)
    pose.rotation =
        Eigen::AngleAxisd(*set.turn_rad - turn_of(pose), Vector3d::UnitZ()) * pose.rotation;
  return pose;
}

Result<void> SceneDesk::apply(const page::SetObject& set, const SeenFrom* from) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(Written now, written());
  MIXRIG_ASSIGN(const scene::Object* object, named(now.scene.objects, set.name, "object"));
  if (object->physics && (set.position_m || set.at || set.onto || set.turn_rad))
    return Error{ErrorCode::kUnsupported, "\"" + set.name + "\" is moved by physics"};
  MIXRIG_ASSIGN(const geometry::Pose pose, wanted_pose(*object, set, from));
  follower_->preview_object(set.name, pose);
  {
    const std::lock_guard lock(mutex_);
    previews_of_now().poses[set.name] = pose;
  }
  if (set.preview) return {};
  MIXRIG_ASSIGN(std::string text, with_poses(std::move(now.text), set.name));
  MIXRIG_ASSIGN(
      text, scene::with_object(text, session_.scene.path, set.name, {pose, set.scale, set.hidden}));
  return write_file(session_.scene.path, text);
}

Result<void> SceneDesk::apply(const page::AddObject& add, const SeenFrom* from) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const SeenFrom* used, seen(from));
  scene::Object object;
  object.name = add.name;
  MIXRIG_ASSIGN(object.model, scene::load_gltf(add.glb));
  // In the lower middle of the picture, on the floor.
  MIXRIG_ASSIGN(Vector3d place, point_on_level(*used, {0.5, 0.7}, 0));
  place.z() = -static_cast<double>(scene::bounds(object.model).min_m.z());
  object.world_from_object.translation_m = place;
  const fs::path folder = session_.scene.path.parent_path();
  object.model_path = free_model_path(folder, add.name);
  MIXRIG_ASSIGN(Written now, written());
  MIXRIG_ASSIGN(const std::string text, with_poses(std::move(now.text), ""));
  std::error_code code;
  fs::create_directories(folder / "models", code);
  if (!code) fs::copy_file(add.glb, folder / object.model_path, code);
  if (code)
    return system_error(ErrorCode::kIo,
                        "cannot write '" + (folder / object.model_path).string() + "'",
                        code.value());
  auto edited = scene::with_new_object(text, session_.scene.path, object);
  Result<void> done = edited ? write_file(session_.scene.path, *edited) : edited.error();
  if (!done) fs::remove(folder / object.model_path, code);
  return done;
}

Result<void> SceneDesk::apply(const page::RemoveObject& remove) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(Written now, written());
  const auto found = named(now.scene.objects, remove.name, "object");
  if (!found) return found.error();
  MIXRIG_ASSIGN(std::string text, with_poses(std::move(now.text), remove.name));
  MIXRIG_ASSIGN(text, scene::without_object(text, session_.scene.path, remove.name));
  return write_file(session_.scene.path, text);
}

/// Writes focus settings. New ones without a place make the middle of the picture sharp.
Result<void> SceneDesk::apply(const page::SetFocus& set) {
  const std::lock_guard lock(follower_->edit_mutex());
  MIXRIG_ASSIGN(Written now, written());
  const fs::path& path = session_.scene.path;
  MIXRIG_ASSIGN(std::string text, with_poses(std::move(now.text), ""));
  if (set.on == false) {
    MIXRIG_ASSIGN(text, scene::without_focus(text, path));
    return write_file(path, text);
  }
  std::optional<Eigen::Vector2d> at = set.at;
  if (!now.scene.focus && !at && !set.distance_m) at = Eigen::Vector2d(0.5, 0.5);
  scene::FocusEdit edit{set.distance_m, std::nullopt, set.f_number};
  const Size view = session_.setup.view.size_px;
  const auto pixel = [](double place, int size) {
    return std::clamp(static_cast<int>(place * size), 0, size - 1);
  };
  if (at) edit.pixel = {pixel(at->x(), view.width), pixel(at->y(), view.height)};
  MIXRIG_ASSIGN(text, scene::with_focus(text, path, edit));
  return write_file(path, text);
}

Result<void> SceneDesk::use_background(const fs::path& model) {
  const std::lock_guard lock(follower_->edit_mutex());
  MIXRIG_ASSIGN(Written now, written());
  MIXRIG_ASSIGN(const std::string text,
                scene::with_background_model(now.text, session_.scene.path, model));
  return write_file(session_.scene.path, text);
}

std::optional<scene::FocusSettings> SceneDesk::focus() const {
  const EditedScenePtr now = follower_->newest();
  return shown_scene(now).focus;
}

Result<void> SceneDesk::save() {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(Written now, written());
  const Previews shown = previews();
  MIXRIG_ASSIGN(std::string edited, with_poses(now.text, ""));
  if (!shown.lamps.empty()) return write_lamps(std::move(edited), lamps_of(now.scene));
  return edited == now.text ? Result<void>() : write_file(session_.scene.path, edited);
}

std::vector<page::ObjectState> SceneDesk::objects(const SeenFrom* from) const {
  const EditedScenePtr now = follower_->newest();
  const Previews shown = previews();
  std::vector<page::ObjectState> states;
  for (const scene::Object& object : shown_scene(now).objects) {
    const auto preview = shown.poses.find(object.name);
    const geometry::Pose& pose =
        preview != shown.poses.end() ? preview->second : object.world_from_object;
    page::ObjectState& state = states.emplace_back();
    state.name = object.name, state.scale = object.scale, state.hidden = object.hidden;
    state.position_m = pose.translation_m, state.turn_rad = turn_of(pose);
    state.moves = object.physics.has_value();
    if (from != nullptr) state.at = place_in_picture(*from, pose.translation_m);
  }
  return states;
}

}  // namespace mixrig::session
