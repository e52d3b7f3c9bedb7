// SPDX-License-Identifier: Apache-2.0
#include "host/run/controls/scene_follower.h"

#include <algorithm>
#include <chrono>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "host/run/session/session.h"
#include "host/scene/scene_changes.h"

namespace mixrig::session {
namespace {

constexpr std::chrono::milliseconds kLookInterval{100};

template <typename Named>
const Named* find_named(const std::vector<Named>& all, std::string_view name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

template <typename Value>
const Value* find_preview(const std::vector<std::pair<std::string, Value>>& previews,
                          std::string_view name) {
  const auto found = std::find_if(previews.begin(), previews.end(),
                                  [&](const auto& preview) { return preview.first == name; });
  return found == previews.end() ? nullptr : &found->second;
}

template <typename Value>
void set_preview(std::vector<std::pair<std::string, Value>>& previews, std::string_view name,
                 const Value& value) {
  for (auto& preview : previews)
    if (preview.first == name) {
      preview.second = value;
      return;
    }
  previews.emplace_back(name, value);
}

}  // namespace

SceneFollower::SceneFollower(const Session& session, bool live)
    : session_(session), live_(live), read_stamp_(stamp_of(session.scene)) {
  last_stamp_ = read_stamp_;
  if (live_) thread_ = std::thread([this] { watch(); });
}

SceneFollower::~SceneFollower() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void SceneFollower::preview_object(std::string_view name, const geometry::Pose& world_from_object) {
  const std::lock_guard lock(mutex_);
  if (find_named(newest_scene().objects, name) != nullptr)
    set_preview(object_previews_, name, world_from_object);
}

void SceneFollower::preview_lamp(std::string_view name, const Eigen::Vector3f& intensity) {
  const std::lock_guard lock(mutex_);
  if (find_named(newest_scene().light.lamps, name) != nullptr)
    set_preview(lamp_previews_, name, intensity);
}

void SceneFollower::drop_previews() {
  const std::lock_guard lock(mutex_);
  object_previews_.clear(), lamp_previews_.clear();
}

EditedScenePtr SceneFollower::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

SceneEdits SceneFollower::edits() const {
  const std::lock_guard lock(mutex_);
  return edits_;
}

EditedScenePtr SceneFollower::take_edited() {
  if (!live_) look();
  const std::lock_guard lock(mutex_);
  return std::exchange(is_new_, false) ? newest_ : nullptr;
}

bool SceneFollower::fill(const scene::Scene& in_use, FrameScene& frame) {
  const std::lock_guard lock(mutex_);
  const scene::Scene& newest = newest_scene();
  bool differs = false;
  frame.world_from_object.clear(), frame.lamp_intensity.clear();
  for (const scene::Object& object : in_use.objects) {
    const geometry::Pose* pose = find_preview(object_previews_, object.name);
    const scene::Object* now = find_named(newest.objects, object.name);
    if (pose == nullptr) pose = &(now != nullptr ? now : &object)->world_from_object;
    frame.world_from_object.push_back(*pose);
    differs |= !(*pose == object.world_from_object);
  }
  for (const scene::Lamp& lamp : in_use.light.lamps) {
    const Eigen::Vector3f* intensity = find_preview(lamp_previews_, lamp.name);
    const scene::Lamp* now = find_named(newest.light.lamps, lamp.name);
    if (intensity == nullptr) intensity = &(now != nullptr ? now : &lamp)->intensity;
    frame.lamp_intensity.emplace_back(intensity->x(), intensity->y(), intensity->z());
    differs |= *intensity != lamp.intensity;
  }
  const Eigen::Vector3f& ambient = newest.light.ambient;
  frame.light = {{ambient.x(), ambient.y(), ambient.z()},
                 static_cast<float>(newest.light.exposure),
                 frame.lamp_intensity};
  differs |= ambient != in_use.light.ambient || newest.light.exposure != in_use.light.exposure;
  return std::exchange(previewed_, differs) || differs;
}

void SceneFollower::watch() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kLookInterval, [this] { return ends_; })) {
    lock.unlock();
    const Result<void> done = guarded("reading the scene", [this] { look(); });
    if (!done)
      log_warning("session", done.error().context + ": the run goes on with the one before");
    lock.lock();
  }
}

/// A file that is being written is left alone until it stays the same from one look to the next.
void SceneFollower::look() {
  EditedScenePtr newest = this->newest();
  Stamp stamp = stamp_of(newest ? newest->scene : session_.scene);
  const bool is_written = live_ && stamp != last_stamp_;
  last_stamp_ = stamp;
  if (is_written || stamp == read_stamp_) return;
  read_stamp_ = std::move(stamp);
  read();
}

/// Time stamps of the file and of the models of `scene`.
SceneFollower::Stamp SceneFollower::stamp_of(const scene::Scene& scene) const {
  Stamp stamp;
  const auto add = [&](const std::filesystem::path& path) {
    std::error_code none;
    const auto time = std::filesystem::last_write_time(path, none);
    const auto size = std::filesystem::file_size(path, none);
    stamp.emplace_back(none ? std::filesystem::file_time_type{} : time, none ? 0 : size);
  };
  add(session_.scene.path);
  for (const scene::Object& object : scene.objects) add(object.model_path);
  return stamp;
}

void SceneFollower::read() {
  auto scene = scene::load_scene(session_.scene.path);
  if (scene) return adopt(*std::move(scene));
  log_warning("session", scene.error().context + ": the run goes on with the scene before");
  const std::lock_guard lock(mutex_);
  ++edits_.refused;
}

void SceneFollower::adopt(scene::Scene scene) {
  const std::string fixed = scene::fixed_changes(session_.scene, scene);
  if (!fixed.empty())
    log_warning("session", session_.scene.path.string() + ": " + fixed +
                               ": is taken when the run is started again");
  const bool touched = session_.scene.events ||
                       std::any_of(session_.scene.objects.begin(), session_.scene.objects.end(),
                                   [](const auto& o) { return o.physics; });
  // Settings that a run takes only once stay unchanged.
  scene.set = session_.scene.set;
  if (session_.scene.quality.budget_ms) scene.quality = session_.scene.quality;  // as was chosen
  scene.capture_volume = session_.scene.capture_volume;
  scene.background = session_.scene.background;
  if (session_.scene.light.find_lamps) scene.light = session_.scene.light;
  if (touched && !scene::same_objects(session_.scene, scene)) {
    log_warning("session", session_.scene.path.string() +
                               ": object: people touch these, so that new ones are taken when the "
                               "run is started again; now they may only be moved");
    std::vector<scene::Object> objects = session_.scene.objects;
    for (scene::Object& object : objects)
      if (const scene::Object* now = find_named(scene.objects, object.name))
        object.world_from_object = now->world_from_object;
    scene.objects = std::move(objects);
  }
  std::vector<MeshArrays> meshes = mesh_arrays(scene);
  const Stamp models = stamp_of(scene);
  read_stamp_.resize(1);  // the file may have been saved again meanwhile
  read_stamp_.insert(read_stamp_.end(), models.begin() + 1, models.end());
  const std::lock_guard lock(mutex_);
  newest_ = std::make_shared<EditedScene>(EditedScene{std::move(scene), std::move(meshes)});
  is_new_ = true;
  object_previews_.clear(), lamp_previews_.clear();
  ++edits_.taken;
}

/// Precondition: mutex_ is held.
const scene::Scene& SceneFollower::newest_scene() const {
  return newest_ ? newest_->scene : session_.scene;
}

}  // namespace mixrig::session
