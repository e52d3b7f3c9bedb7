// SPDX-License-Identifier: Apache-2.0
// Skinned meshes at rest, against places worked out by hand.
#include <gtest/gtest.h>

#include "host/scene/scene.h"
#include "tests/support/hand_gltf.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::scene {
namespace {

using test::floats;
using test::shorts;

/// A triangle, its normals, joints (two a vertex are used), weights, and two inverse bind matrices.
struct SkinnedParts {
  std::string positions = floats({0, 0, 0, 1, 0, 0, 0, 2, 0});
  std::string normals = floats({0, 0, 1, 0, 0, 1, 0, 0, 1});
  std::string joints = shorts({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  std::string weights = floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  std::string binds = floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,  //
                              1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
};

/// Nodes: 0 is the mesh, the others as `nodes` says; the joints of the skin are `joints`.
std::string skinned(const std::string& nodes, const std::string& joints, const SkinnedParts& parts,
                    const std::string& mesh_node = "") {
  const std::string bytes =
      parts.positions + parts.normals + parts.joints + parts.weights + parts.binds;
  const auto view = [](int offset, int length) {
    return R"({"buffer":0,"byteOffset":)" + std::to_string(offset) + R"(,"byteLength":)" +
           std::to_string(length) + "}";
  };
  return test::glb(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0)" +
          mesh_node + "}," + nodes + R"(],"skins":[{"joints":)" + joints +
          R"(,"inverseBindMatrices":4}],"meshes":[{"primitives":[{"attributes":
          {"POSITION":0,"NORMAL":1,"JOINTS_0":2,"WEIGHTS_0":3}}]}],
          "buffers":[{"byteLength":)" +
          std::to_string(bytes.size()) + R"(}],"bufferViews":[)" + view(0, 36) + "," +
          view(36, 36) + "," + view(72, 24) + "," + view(96, 48) + "," + view(144, 128) +
          R"(],"accessors":[
          {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
          {"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"},
          {"bufferView":2,"componentType":5123,"count":3,"type":"VEC4"},
          {"bufferView":3,"componentType":5126,"count":3,"type":"VEC4"},
          {"bufferView":4,"componentType":5126,"count":2,"type":"MAT4"}]})",
      bytes);
}

class GltfSkin : public ::testing::Test {
 protected:
  Result<Model> load(const std::string& bytes) { return load_gltf(folder_.write("m.glb", bytes)); }
  /// The vertices of the one mesh, back in glTF's axes.
  std::vector<Eigen::Vector3f> places(const std::string& bytes) {
    const auto model = load(bytes);
    EXPECT_TRUE(model) << model.error().context;
    std::vector<Eigen::Vector3f> out;
    if (model)
      for (const Eigen::Vector3f& p : model->meshes[0].positions_m)
        out.emplace_back(p.x(), p.z(), -p.y());
    return out;
  }
  test::TemporaryFolder folder_;
};

void expect_places(const std::vector<Eigen::Vector3f>& places,
                   std::initializer_list<Eigen::Vector3f> wanted) {
  ASSERT_EQ(places.size(), wanted.size());
  std::size_t i = 0;
  for (const Eigen::Vector3f& place : wanted) {
    EXPECT_LT((places[i] - place).norm(), 1e-5F) << i << ": " << places[i].transpose();
    ++i;
  }
}

/// An armature in centimetres, as characters leave a modelling program.
TEST_F(GltfSkin, VerticesStandWhereTheirJointsStand) {
  SkinnedParts parts;
  parts.positions = floats({0, 0, 0, 100, 0, 0, 0, 200, 0});
  parts.binds = floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -20, 0, 1,  //
                        1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,   0, 1});
  expect_places(
      places(skinned(R"({"scale":[0.01,0.01,0.01],"children":[2]},{"translation":[0,20,0]})",
                     "[2,1]", parts)),
      {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}});
}

TEST_F(GltfSkin, TheNodeOfTheMeshDoesNotMoveIt) {
  expect_places(places(skinned(R"({"translation":[0,0,5]})", "[1,1]", {},
                               R"(,"translation":[9,9,9],"scale":[2,2,2])")),
                {{0, 0, 5}, {1, 0, 5}, {0, 2, 5}});
}

/// Half to a joint that stands, half to one that is 4 m to the side; the weights' sum is 2.
TEST_F(GltfSkin, WeightsBlendJointsAndAreMadeToOne) {
  SkinnedParts parts;
  parts.weights = floats({1, 1, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0});
  expect_places(places(skinned(R"({"children":[2]},{"translation":[4,0,0]})", "[1,2]", parts)),
                {{2, 0, 0}, {1, 0, 0}, {4, 2, 0}});
}

TEST_F(GltfSkin, NormalsTurnWithTheirJoint) {
  const auto model = load(skinned(R"({"rotation":[0,0.70710678,0,0.70710678]})", "[1,1]", {}));
  ASSERT_TRUE(model) << model.error().context;
  // A quarter turn about y takes glTF's z to x, which is x of the object.
  EXPECT_LT((model->meshes[0].normals[0] - Eigen::Vector3f(1, 0, 0)).norm(), 1e-5F);
}

TEST_F(GltfSkin, WhatCannotBePlacedIsRefused) {
  SkinnedParts loose;
  loose.weights = floats({1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  EXPECT_TRUE(
      test::refused(load(skinned("{}", "[1,1]", loose)), {"has a skin", "bound to no joint"}));
  SkinnedParts far;
  far.joints = shorts({7, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  EXPECT_TRUE(test::refused(load(skinned("{}", "[1,1]", far)), {"a joint that its skin lacks"}));
  EXPECT_TRUE(test::refused(load(skinned("{}", "[1,9]", {})), {"node 9, which does not exist"}));
  EXPECT_TRUE(test::refused(load(skinned("{}", "[1,1,1]", {})), {"fewer inverse bind matrices"}));
}

}  // namespace
}  // namespace mixrig::scene
