// SPDX-License-Identifier: Apache-2.0
// Changes of a scene's text: what is changed, and that the rest stays.
#include "host/scene/scene_edit.h"

#include <gtest/gtest.h>

#include "host/scene/scene_manifest.h"
#include "tests/support/refusal.h"

namespace mixrig::scene {
namespace {

constexpr const char* kScene = R"(# my scene
[background]
learn = [1, 25]   # empty frames

[[object]]
name = "crate"
model = "crate.glb"
position_m = [1.0, 2.0, 0.0]
yaw_deg = 30.0    # by eye

[[object]]
name = "vase"
model = "vase.glb"
position_m = [0.0, 0.0, 0.0]

[light]
ambient = [0.3, 0.3, 0.3]
exposure = 1.1    # measured

# typed in
[[light.lamp]]
name = "old"
position_m = [1.0, 1.0, 2.9]

[[light.lamp]]
position_m = [3.0, 1.0, 2.9]

# how people are found
[key]
threshold_m = 0.05
)";

Lamp lamp(double x) {
  Lamp lamp;
  lamp.name = "found";
  lamp.position_m = {x, 1.5, 2.9}, lamp.direction = -Eigen::Vector3d::UnitZ();
  lamp.size_m = {0.6, 0.3}, lamp.intensity = {2, 3, 4};
  return lamp;
}

TEST(SceneEdit, LampsAreReplacedAndTheRestStays) {
  const std::vector<Lamp> lamps{lamp(1), lamp(2), lamp(3)};
  const auto text = with_lamps(kScene, "scene.toml", lamps, Eigen::Vector3f(0.1F, 0.2F, 0.3F));
  ASSERT_TRUE(text) << text.error().context;
  const auto scene = parse_scene(*text, "scene.toml", false);
  ASSERT_TRUE(scene) << scene.error().context;
  ASSERT_EQ(scene->light.lamps.size(), 3U);
  EXPECT_EQ(scene->light.lamps[2].position_m, Eigen::Vector3d(3, 1.5, 2.9));
  EXPECT_EQ(scene->light.lamps[0].size_m, Eigen::Vector2d(0.6, 0.3));
  EXPECT_NEAR(scene->light.ambient.z(), 0.3, 1e-6);
  EXPECT_EQ(scene->objects.size(), 2U);
  for (const char* kept : {"# my scene", "# empty frames", "# by eye", "# measured", "# typed in",
                           "# how people are found"})
    EXPECT_NE(text->find(kept), std::string::npos) << kept;
  EXPECT_EQ(text->find("\"old\""), std::string::npos);
  // Adding the same lamps again changes nothing.
  const auto again = with_lamps(*text, "scene.toml", lamps, Eigen::Vector3f(0.1F, 0.2F, 0.3F));
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, *text);
}

TEST(SceneEdit, LampsOfASceneWithoutLight) {
  const std::vector<Lamp> lamps{lamp(1)};
  for (const char* before : {"", "[key]\nthreshold_m = 0.05\n", "[light]\nexposure = 2.0\n"})
    for (const bool ambient : {false, true}) {
      const auto text =
          with_lamps(before, "scene.toml", lamps,
                     ambient ? std::optional(Eigen::Vector3f(1, 1, 1)) : std::nullopt);
      ASSERT_TRUE(text) << before << text.error().context;
      const auto scene = parse_scene(*text, "scene.toml", false);
      ASSERT_TRUE(scene) << scene.error().context << *text;
      EXPECT_EQ(scene->light.lamps.size(), 1U);
      if (ambient) {
        EXPECT_EQ(scene->light.ambient.x(), 1);
      }
    }
}

TEST(SceneEdit, LightThatIsNotInTablesIsRefused) {
  const std::vector<Lamp> lamps{lamp(1)};
  const auto inline_lamps =
      with_lamps("light = { exposure = 1.0, lamp = [{ position_m = [0.0, 0.0, 1.0] }] }\n",
                 "scene.toml", lamps, {});
  EXPECT_TRUE(test::refused(inline_lamps, {}, ErrorCode::kFormat));
  EXPECT_FALSE(with_lamps("[light\n", "scene.toml", lamps, {}));
}

TEST(SceneEdit, AnObjectsPoseIsReplaced) {
  const geometry::Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX())),
                            {1.25, 2.5, 0.75}};
  for (const char* name : {"crate", "vase"}) {
    const auto text = with_object_pose(kScene, "scene.toml", name, pose);
    ASSERT_TRUE(text) << text.error().context;
    const auto scene = parse_scene(*text, "scene.toml", false);
    ASSERT_TRUE(scene) << scene.error().context << *text;
    const bool first = std::string(name) == "crate";
    const Object &moved = scene->objects[first ? 0 : 1], &other = scene->objects[first ? 1 : 0];
    EXPECT_LT((moved.world_from_object.translation_m - pose.translation_m).norm(), 1e-6);
    EXPECT_LT(moved.world_from_object.rotation.angularDistance(pose.rotation), 1e-6);
    EXPECT_EQ(other.world_from_object.translation_m,
              first ? Eigen::Vector3d::Zero() : Eigen::Vector3d(1, 2, 0));
    EXPECT_EQ(scene->light.lamps.size(), 2U);
    EXPECT_NE(text->find("# my scene"), std::string::npos);
  }
  EXPECT_TRUE(
      test::refused(with_object_pose(kScene, "scene.toml", "chair", pose), {"crate, vase"}));
}

TEST(SceneEdit, AnObjectIsScaledAndHidden) {
  const auto text = with_object(kScene, "scene.toml", "crate", {std::nullopt, 0.5, true});
  ASSERT_TRUE(text) << text.error().context;
  auto scene = parse_scene(*text, "scene.toml", false);
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->objects[0].scale, 0.5);
  EXPECT_TRUE(scene->objects[0].hidden);
  EXPECT_FALSE(scene->objects[1].hidden);
  EXPECT_NE(text->find("# by eye"), std::string::npos) << "its pose stays as it was written";
  const auto shown = with_object(*text, "scene.toml", "crate", {std::nullopt, std::nullopt, false});
  ASSERT_TRUE(shown);
  scene = parse_scene(*shown, "scene.toml", false);
  EXPECT_FALSE(scene->objects[0].hidden);
  EXPECT_EQ(scene->objects[0].scale, 0.5);
  EXPECT_EQ(with_object(kScene, "scene.toml", "chair", {}).error().code, ErrorCode::kUsage);
  EXPECT_FALSE(with_object(kScene, "scene.toml", "crate", {std::nullopt, 0.0, std::nullopt}));
}

TEST(SceneEdit, AnObjectComesAndGoes) {
  Object lamp;
  lamp.name = "a \"floor\" lamp", lamp.model_path = "lamp.glb", lamp.scale = 2;
  lamp.world_from_object.translation_m = {1, 2, 0.25};
  const auto added = with_new_object(kScene, "scene.toml", lamp);
  ASSERT_TRUE(added) << added.error().context;
  const auto scene = parse_scene(*added, "scene.toml", false);
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->objects.size(), 3U);
  EXPECT_EQ(scene->objects[2].name, lamp.name);
  EXPECT_EQ(scene->objects[2].world_from_object.translation_m,
            lamp.world_from_object.translation_m);
  EXPECT_EQ(with_new_object(*added, "scene.toml", lamp).error().code, ErrorCode::kUsage);
  const auto removed = without_object(*added, "scene.toml", lamp.name);
  ASSERT_TRUE(removed) << removed.error().context;
  const auto before = parse_scene(*removed, "scene.toml", false);
  ASSERT_TRUE(before);
  EXPECT_EQ(before->objects.size(), 2U);
  const auto first = without_object(kScene, "scene.toml", "crate");
  ASSERT_TRUE(first) << first.error().context;
  EXPECT_EQ(parse_scene(*first, "scene.toml", false)->objects[0].name, "vase");
  for (const char* kept : {"# my scene", "# empty frames", "# measured", "# typed in"})
    EXPECT_NE(first->find(kept), std::string::npos) << kept;
}

TEST(SceneEdit, AnObjectGoesWithItsPhysics) {
  const std::string text = R"([[object]]
name = "ball"
model = "ball.glb"
position_m = [0, 0, 1]

[object.physics]
mass_kg = 1.0

# of the second one
[[object]]
name = "vase"
model = "vase.glb"
position_m = [0, 0, 0]
)";
  const auto left = without_object(text, "scene.toml", "ball");
  ASSERT_TRUE(left) << left.error().context;
  const auto scene = parse_scene(*left, "scene.toml", false);
  ASSERT_EQ(scene->objects.size(), 1U);
  EXPECT_FALSE(scene->objects[0].physics);
  EXPECT_NE(left->find("# of the second one"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::scene
