// SPDX-License-Identifier: Apache-2.0
// Real glTF files (label data), against numbers that their authors publish.
#include <cstdlib>

#include <gtest/gtest.h>

#include "host/scene/scene.h"

namespace mixrig::scene {
namespace {

/// Volume inside a closed surface whose triangles face outwards (divergence theorem).
double enclosed_m3(const Model& model) {
  double volume = 0;
  for (const Mesh& mesh : model.meshes)
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const auto corner = [&](std::size_t k) {
        return mesh.positions_m[mesh.indices[i + k]].cast<double>();
      };
      volume += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
    }
  return volume;
}

Model checked_in(const std::string& name) {
  const std::string source =
      std::getenv("MIXRIG_SOURCE") != nullptr ? std::getenv("MIXRIG_SOURCE") : ".";
  auto model = load_gltf(source + "/tests/data/models/" + name);
  EXPECT_TRUE(model) << model.error().context;
  return model ? *std::move(model) : Model();
}

TEST(CheckedInModels, TheCrateStandsOnTheFloorAndFacesOutwards) {
  const Model crate = checked_in("crate.glb");
  ASSERT_EQ(crate.meshes.size(), 1U);
  EXPECT_TRUE(bounds(crate).min_m.isApprox(Eigen::Vector3f(-0.3F, -0.3F, 0.0F), 1e-6F));
  EXPECT_TRUE(bounds(crate).max_m.isApprox(Eigen::Vector3f(0.3F, 0.3F, 0.6F), 1e-6F));
  EXPECT_NEAR(enclosed_m3(crate), 0.6 * 0.6 * 0.6, 1e-6);
  ASSERT_EQ(crate.textures.size(), 1U);
  EXPECT_EQ(crate.textures[0].size(), (Size{64, 64}));
}

TEST(CheckedInModels, TheCarStandsOnItsWheelsAndFacesOutwards) {
  const Model car = checked_in("car.glb");
  ASSERT_EQ(car.meshes.size(), 4U) << "body, cabin, lamps, wheels";
  EXPECT_NEAR(bounds(car).min_m.z(), 0.0F, 1e-6F);
  EXPECT_NEAR(bounds(car).max_m.x() - bounds(car).min_m.x(), 1.005F, 1e-3F);
  for (const Mesh& mesh : car.meshes) EXPECT_GT(enclosed_m3({{mesh}, {}}), 0.0);
}

class Models : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("MIXRIG_DATA") == nullptr)
      GTEST_SKIP() << "needs models: set MIXRIG_DATA to the folder that holds them";
    folder_ = std::string(std::getenv("MIXRIG_DATA")) + "/models/";
  }
  Model load(const std::string& name) {
    auto model = load_gltf(folder_ + name);
    EXPECT_TRUE(model) << model.error().context;
    return model ? *std::move(model) : Model();
  }
  std::string folder_;
};

TEST_F(Models, TheBoxIsACubeOfOneMetreInRed) {
  const Model box = load("Box.glb");
  ASSERT_EQ(box.meshes.size(), 1U);
  EXPECT_EQ(box.meshes[0].indices.size(), 36U);
  EXPECT_TRUE(bounds(box).min_m.isApprox(Eigen::Vector3f::Constant(-0.5F), 1e-5F));
  EXPECT_TRUE(bounds(box).max_m.isApprox(Eigen::Vector3f::Constant(0.5F), 1e-5F));
  EXPECT_NEAR(box.meshes[0].base_color.x(), 0.8F, 0.01F);
}

TEST_F(Models, TexturedBoxesComeFromOneFileOrFromSeveral) {
  const Model whole = load("BoxTextured.glb");
  const Model parts = load("BoxTextured-glTF/BoxTextured.gltf");
  ASSERT_EQ(whole.textures.size(), 1U);
  ASSERT_EQ(parts.textures.size(), 1U);
  EXPECT_EQ(whole.textures[0].size(), parts.textures[0].size());
  ASSERT_FALSE(whole.meshes.empty());
  EXPECT_EQ(whole.meshes[0].texture, 0);
  EXPECT_EQ(whole.meshes[0].uv.size(), whole.meshes[0].positions_m.size());
}

TEST_F(Models, TheDuckStandsUpright) {
  const Model duck = load("Duck.glb");
  ASSERT_EQ(duck.meshes.size(), 1U);
  EXPECT_EQ(duck.meshes[0].indices.size(), 4212U * 3);
  const Bounds box = bounds(duck);
  EXPECT_GT(box.max_m.z() - box.min_m.z(), 1.0F) << "it is about 1.5 m high";
  EXPECT_EQ(duck.textures.size(), 1U);
}

}  // namespace
}  // namespace mixrig::scene
