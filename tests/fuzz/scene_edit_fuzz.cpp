// SPDX-License-Identifier: Apache-2.0
// Changes of any text that may be a scene: the result is a scene with the change, or an error.
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "host/scene/scene_edit.h"
#include "host/scene/scene_manifest.h"
#include "host/scene/settings_edit.h"
#include "tests/fuzz/target.h"

MIXRIG_FUZZ_TARGET(scene_edit) {
  using namespace mixrig;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  geometry::Lamp lamp;
  lamp.position_m = {1, 2, 3};
  const auto lit = scene::with_lamps(text, "scene.toml", {&lamp, 1}, Eigen::Vector3f(1, 1, 1));
  if (lit && scene::parse_scene(*lit, "scene.toml", false)->light.lamps.size() != 1) std::abort();
  const geometry::Pose pose{Eigen::Quaterniond::Identity(), {1, 2, 3}};
  const auto placed = scene::with_object_pose(text, "scene.toml", "crate", pose);
  if (placed && !scene::parse_scene(*placed, "scene.toml", false)) std::abort();
  const auto sharp = scene::with_focus(text, "scene.toml", {1.5, {}, 2.0});
  if (sharp && scene::parse_scene(*sharp, "scene.toml", false)->focus->distance_m != 1.5)
    std::abort();
  const auto blurred = scene::without_focus(text, "scene.toml");
  if (blurred && scene::parse_scene(*blurred, "scene.toml", false)->focus) std::abort();
  const auto roomy = scene::with_background_model(text, "scene.toml", "rooms/room 1");
  if (roomy && !scene::parse_scene(*roomy, "scene.toml", false)->background.model) std::abort();
  return 0;
}
