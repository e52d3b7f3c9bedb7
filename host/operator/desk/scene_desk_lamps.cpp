// SPDX-License-Identifier: Apache-2.0
// Lamps of the scene desk.
#include <algorithm>
#include <utility>

#include "host/operator/desk/desk_lookup.h"
#include "host/operator/desk/place.h"
#include "host/operator/desk/scene_desk.h"
#include "host/scene/scene_edit.h"

namespace mixrig::session {

using Eigen::Vector3d;

/// Lamps as they are shown.
std::vector<scene::Lamp> SceneDesk::lamps_of(const scene::Scene& scene) const {
  const Previews shown = previews();
  std::vector<scene::Lamp> lamps = scene.light.lamps;
  for (scene::Lamp& lamp : lamps)
    if (const auto found = shown.lamps.find(lamp.name); found != shown.lamps.end())
      lamp.intensity = found->second;
  return lamps;
}

Result<void> SceneDesk::write_lamps(const Written& before, const std::vector<scene::Lamp>& lamps,
                                    std::string what) const {
  MIXRIG_ASSIGN(std::string text, with_poses(before.text, ""));
  MIXRIG_ASSIGN(text, scene::with_lamps(text, session_.scene.path, lamps, std::nullopt));
  return put(before, text, std::move(what));
}

/// A lamp that is off has no intensity; what it had is kept for when it is switched on again.
Eigen::Vector3f SceneDesk::wanted_intensity(const page::SetLamp& set, const Eigen::Vector3f& old) {
  Eigen::Vector3f wanted = old;
  const std::lock_guard lock(mutex_);
  const bool was_on = old.maxCoeff() > 0;
  if (set.on == false && was_on) dark_[set.name] = old;
  if (set.on == true && !was_on)
    wanted = dark_.contains(set.name) ? dark_[set.name] : Eigen::Vector3f(1, 1, 1);
  if (set.intensity) wanted = *set.intensity;
  if (set.on == false) wanted.setZero();
  previews_of_now().lamps[set.name] = wanted;
  return wanted;
}

Result<void> SceneDesk::apply(const page::SetLamp& set) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  std::vector<scene::Lamp> lamps = lamps_of(now.scene);
  MIXRIG_ASSIGN(const scene::Lamp* old, named(lamps, set.name, "lamp"));
  scene::Lamp& lamp = lamps[static_cast<std::size_t>(old - lamps.data())];
  lamp.intensity = wanted_intensity(set, lamp.intensity);
  follower_->preview_lamp(set.name, lamp.intensity);
  if (set.preview) return {};
  const std::string what = set.intensity || !set.on ? "dim "
                           : *set.on                ? "switch on "
                                                    : "switch off ";
  return write_lamps(now, lamps, what + set.name);
}

Result<Vector3d> SceneDesk::lamp_position(const page::AddLamp& add, const SeenFrom* from) const {
  constexpr double kBeforeSurface_m = 0.05;  // else the surface would be in its own light
  if (add.position_m) return *add.position_m;
  MIXRIG_ASSIGN(const SeenFrom* used, seen(from));
  if (add.height_m) return point_on_level(*used, *add.at, *add.height_m);
  if (add.above_floor_m) {
    MIXRIG_ASSIGN(const Vector3d floor, point_on_level(*used, *add.at, 0));
    return Vector3d(floor + *add.above_floor_m * Vector3d::UnitZ());
  }
  MIXRIG_ASSIGN(const Vector3d surface, point_on_room(session_, *used, *add.at));
  const Vector3d to_eye = used->world_from_view.translation_m - surface;
  return Vector3d(surface + kBeforeSurface_m * to_eye.normalized());
}

Result<void> SceneDesk::apply(const page::AddLamp& add, const SeenFrom* from) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  std::vector<scene::Lamp> lamps = lamps_of(now.scene);
  const auto taken = [&](const std::string& name) {
    return std::any_of(lamps.begin(), lamps.end(), [&](const auto& l) { return l.name == name; });
  };
  scene::Lamp lamp;
  lamp.name = add.name;
  for (std::size_t i = lamps.size() + 1;
       lamp.name.empty() || (add.name.empty() && taken(lamp.name)); ++i)
    lamp.name = "lamp " + std::to_string(i);
  if (taken(lamp.name))
    return Error{ErrorCode::kUsage, "there is a lamp \"" + lamp.name + "\": give another name"};
  lamp.intensity = add.intensity;
  MIXRIG_ASSIGN(lamp.position_m, lamp_position(add, from));
  lamps.push_back(lamp);
  return write_lamps(now, lamps, "add " + lamp.name);
}

Result<void> SceneDesk::apply(const page::RemoveLamp& remove) {
  const std::lock_guard edit(follower_->edit_mutex());
  MIXRIG_ASSIGN(const Written now, written());
  std::vector<scene::Lamp> lamps = lamps_of(now.scene);
  MIXRIG_ASSIGN(const scene::Lamp* old, named(lamps, remove.name, "lamp"));
  lamps.erase(lamps.begin() + (old - lamps.data()));
  return write_lamps(now, lamps, "remove " + remove.name);
}

std::vector<page::LampState> SceneDesk::lamps(const SeenFrom* from) const {
  const EditedScenePtr now = follower_->newest();
  const Previews shown = previews();
  std::vector<page::LampState> states;
  for (const scene::Lamp& lamp : shown_scene(now).light.lamps) {
    const auto preview = shown.lamps.find(lamp.name);
    page::LampState& state = states.emplace_back();
    state.name = lamp.name, state.position_m = lamp.position_m;
    state.intensity = preview != shown.lamps.end() ? preview->second : lamp.intensity;
    state.on = state.intensity.maxCoeff() > 0;
    if (from != nullptr) state.at = place_in_picture(*from, lamp.position_m);
  }
  return states;
}

}  // namespace mixrig::session
