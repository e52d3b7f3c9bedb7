// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/scene_desk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hal/base/partial_path.h"
#include "host/math/config/table.h"
#include "host/operator/desk/desk_lookup.h"
#include "host/operator/desk/place.h"
#include "host/scene/preset_text.h"
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

/// Name of a change: "move crate".
std::string what_of(const page::SetObject& set) {
  if (set.rename) return "rename " + set.name;
  if (set.position_m || set.at || set.onto) return "move " + set.name;
  if (set.hidden) return (*set.hidden ? "hide " : "show ") + set.name;
  return (set.turn_rad ? "turn " : set.scale ? "scale " : "change ") + set.name;
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

/// Writes the file, and notes the edit.
Result<void> SceneDesk::put(const Written& before, const std::string& text,
                            std::string what) const {
  if (text == before.text) return {};
  MIXRIG_TRY(write_file(session_.scene.path, text));
  follower_->history().add({std::move(what), session_.scene.path, before.text, text, {}, {}});
  return {};
}

/// Drops the preview of an object that has lost its name.
void SceneDesk::forget_preview(const std::string& object) {
  const std::lock_guard lock(mutex_);
  previews_.poses.erase(object);
}

void SceneDesk::forget_previews() {
  follower_->drop_previews();
  const std::lock_guard lock(mutex_);
  previews_ = {};
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
  MIXRIG_ASSIGN(const Written now, written());
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
  const auto write = [&]() -> Result<void> {
    MIXRIG_ASSIGN(std::string text, with_poses(now.text, set.name));
    MIXRIG_ASSIGN(text, scene::with_object(text, session_.scene.path, set.name,
                                           {pose, set.scale, set.hidden, set.rename}));
    return put(now, text, what_of(set));
  };
  if (const Result<void> done = write(); !done) {  // the picture shows what the file says
    follower_->preview_object(set.name, object->world_from_object);
    forget_preview(set.name);
    return done;
  }
  if (set.rename && *set.rename != set.name) forget_preview(set.name);
  return {};
}

/// Writes focus settings. New ones without a place make the middle of the picture sharp.
Result<void> SceneDesk::apply(const page::SetFocus& set) {
  const std::lock_guard lock(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  const fs::path& path = session_.scene.path;
  MIXRIG_ASSIGN(std::string text, with_poses(now.text, ""));
  if (set.on == false) {
    MIXRIG_ASSIGN(text, scene::without_focus(text, path));
    return put(now, text, "depth of field off");
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
  return put(now, text, "depth of field");
}

Result<void> SceneDesk::use_background(const fs::path& model) {
  const std::lock_guard lock(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  MIXRIG_ASSIGN(const std::string text,
                scene::with_background_model(now.text, session_.scene.path, model));
  return put(now, text, "background " + model.string());
}

std::optional<scene::FocusSettings> SceneDesk::focus() const {
  const EditedScenePtr now = follower_->newest();
  return shown_scene(now).focus;
}

Result<void> SceneDesk::save() {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  const Previews shown = previews();
  if (!shown.lamps.empty()) return write_lamps(now, lamps_of(now.scene), "save");
  MIXRIG_ASSIGN(const std::string edited, with_poses(now.text, ""));
  return put(now, edited, "save");
}

Result<std::string> SceneDesk::snapshot() {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  MIXRIG_ASSIGN(const std::string text, with_poses(now.text, ""));
  const Previews shown = previews();
  if (shown.lamps.empty()) return scene::preset_of(text);
  MIXRIG_ASSIGN(const std::string lit,
                scene::with_lamps(text, session_.scene.path, lamps_of(now.scene), std::nullopt));
  return scene::preset_of(lit);
}

Result<void> SceneDesk::recall(const std::string& preset, const std::string& name) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  MIXRIG_ASSIGN(const std::string text, scene::with_preset(now.text, preset, session_.scene.path));
  forget_previews();
  return put(now, text, "preset " + name);
}

Result<void> SceneDesk::discard() {
  forget_previews();
  return {};
}

Result<void> SceneDesk::undo() {
  const std::lock_guard edit(follower_->edit_mutex());
  forget_previews();
  return follower_->history().undo();
}

Result<void> SceneDesk::redo() {
  const std::lock_guard edit(follower_->edit_mutex());
  forget_previews();
  return follower_->history().redo();
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
