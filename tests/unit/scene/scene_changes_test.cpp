// SPDX-License-Identifier: Apache-2.0
// Which changes of a scene a run can follow.
#include "host/scene/scene_changes.h"

#include <gtest/gtest.h>

#include "host/scene/scene_manifest.h"

namespace mixrig::scene {
namespace {

Scene scene_from(const std::string& text) {
  auto scene = parse_scene(text, "scene.toml", false);
  EXPECT_TRUE(scene) << text;
  return scene ? *std::move(scene) : Scene{};
}

const std::string kObject =
    "[[object]]\nname = \"crate\"\nmodel = \"crate.glb\"\nposition_m = [1, 2, 0]\n";

TEST(SceneChanges, ObjectsLightAndKeyAreFollowed) {
  const Scene from = scene_from(kObject);
  for (const std::string& to :
       {std::string(), kObject + "scale = 2.0\n", kObject + "[light]\nambient = 0.5\n",
        kObject + "[quality]\nkey = \"plain\"\n",
        kObject + "[[light.lamp]]\nposition_m = [1, 1, 3]\n"})
    EXPECT_EQ(fixed_changes(from, scene_from(to)), "") << to;
}

TEST(SceneChanges, OthersAreNamed) {
  const Scene from = scene_from(kObject);
  const auto changed = [&](const std::string& more) {
    return fixed_changes(from, scene_from(more + "\n" + kObject));
  };
  EXPECT_EQ(changed("[camera]\npose = \"identity\"\n"), "camera");
  EXPECT_EQ(changed("[background]\nlearn = [1, 2]\n"), "background");
  EXPECT_EQ(changed("[background]\nlearn = [1, 2]\n[set]\nposition_m = [0, 0, 1]\n"),
            "background, set");
  EXPECT_EQ(changed("[people]\nfollow = true\n[events]\nudp = \"h:1\"\n"), "people, events");
  EXPECT_EQ(changed("[[pose_out]]\nudp = \"h:1\"\n"), "pose_out");
  EXPECT_EQ(changed("calibration = \"c.toml\"\n"), "calibration");
}

TEST(SceneChanges, AnObjectThatIsMovedIsTheSame) {
  const Scene from = scene_from(kObject);
  EXPECT_TRUE(same_objects(from, scene_from(kObject + "yaw_deg = 30\n")));
  for (const char* more : {"scale = 2.0\n", "hidden = true\n", "casts_shadow = false\n",
                           "[object.physics]\nmass_kg = 1\n"})
    EXPECT_FALSE(same_objects(from, scene_from(kObject + more))) << more;
  EXPECT_FALSE(same_objects(from, scene_from("")));
  EXPECT_FALSE(same_objects(from, scene_from(kObject + kObject)));
}

}  // namespace
}  // namespace mixrig::scene
