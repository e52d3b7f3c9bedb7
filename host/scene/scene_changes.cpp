// SPDX-License-Identifier: Apache-2.0
#include "host/scene/scene_changes.h"

#include <algorithm>

namespace mixrig::scene {
namespace {

bool same_thing(const Object& a, const Object& b) {
  return a.name == b.name && a.model_path == b.model_path && a.scale == b.scale &&
         a.casts_shadow == b.casts_shadow && a.hidden == b.hidden && a.physics == b.physics;
}

bool same_set(const std::optional<VirtualSet>& a, const std::optional<VirtualSet>& b) {
  if (!a || !b) return !a && !b;
  if (a->picture_path != b->picture_path || a->model.has_value() != b->model.has_value())
    return false;
  return !a->model || (same_thing(*a->model, *b->model) &&
                       a->model->world_from_object == b->model->world_from_object);
}

}  // namespace

std::string fixed_changes(const Scene& from, const Scene& to) {
  std::string keys;
  const auto note = [&](bool same, const char* key) {
    if (!same) keys += (keys.empty() ? "" : ", ") + std::string(key);
  };
  note(from.calibration == to.calibration, "calibration");
  note(from.pose_source == to.pose_source && from.camera == to.camera &&
           from.capture_volume == to.capture_volume,
       "camera");
  note(from.background == to.background, "background");
  note(same_set(from.set, to.set), "set");
  note(from.light.find_lamps == to.light.find_lamps, "light.lamps");
  note(from.quality.budget_ms == to.quality.budget_ms, "quality.budget_ms");
  note(from.follow_people == to.follow_people, "people");
  note(from.events == to.events, "events");
  note(from.pose_outs == to.pose_outs, "pose_out");
  note(from.stream_outs == to.stream_outs, "stream_out");
  return keys;
}

bool same_objects(const Scene& from, const Scene& to) {
  return std::equal(from.objects.begin(), from.objects.end(), to.objects.begin(), to.objects.end(),
                    same_thing);
}

}  // namespace mixrig::scene
