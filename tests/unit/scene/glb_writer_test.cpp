// SPDX-License-Identifier: Apache-2.0
// Written files are read again by the scene's own reader and by assimp.
#include "host/scene/gltf/glb_writer.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

#ifdef MIXRIG_HAS_ASSIMP
#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#endif

namespace mixrig::scene {
namespace {

/// A triangle in object axes, z up, with a picture of 4x2 pixels.
Model one_triangle() {
  Model model;
  Mesh& mesh = model.meshes.emplace_back();
  mesh.positions_m = {{1, 2, 3}, {2, 2, 3}, {1, 2, 5}};
  mesh.normals.assign(3, {0, -1, 0});
  mesh.uv = {{0, 1}, {1, 1}, {0, 0.25F}};
  mesh.indices = {0, 1, 2};
  mesh.texture = 0;
  model.textures.emplace_back(Size{4, 2}, Rgb8{10, 200, 30});
  return model;
}

std::filesystem::path written(const test::TemporaryFolder& folder) {
  const auto path = folder / "triangle.glb";
  const auto done = write_glb(one_triangle(), "room", path);
  EXPECT_TRUE(done);
  return path;
}

TEST(GlbWriter, IsReadAgainByTheScene) {
  const test::TemporaryFolder folder;
  const auto read = load_gltf(written(folder));
  ASSERT_TRUE(read);
  const Model truth = one_triangle();
  ASSERT_EQ(read->meshes.size(), 1U);
  const Mesh& mesh = read->meshes[0];
  EXPECT_EQ(mesh.positions_m, truth.meshes[0].positions_m);
  EXPECT_EQ(mesh.normals, truth.meshes[0].normals);
  EXPECT_EQ(mesh.uv, truth.meshes[0].uv);
  EXPECT_EQ(mesh.indices, truth.meshes[0].indices);
  EXPECT_EQ(read->textures.at(0).at(3, 1), (Rgb8{10, 200, 30}));
}

TEST(GlbWriter, GlossIsReadAgain) {
  const test::TemporaryFolder folder;
  Model model = one_triangle();
  model.meshes[0].metallic = 0.25F, model.meshes[0].roughness = 0.5F;
  for (const float specular : {0.0F, 0.5F, 1.0F}) {
    model.meshes[0].specular = specular;
    ASSERT_TRUE(write_glb(model, "room", folder / "glossy.glb"));
    const auto read = load_gltf(folder / "glossy.glb");
    ASSERT_TRUE(read);
    EXPECT_EQ(read->meshes[0].specular, specular);
    EXPECT_EQ(read->meshes[0].metallic, 0.25F);
    EXPECT_EQ(read->meshes[0].roughness, 0.5F);
  }
}

TEST(GlbWriter, IsReadByAssimp) {
#ifdef MIXRIG_HAS_ASSIMP
  const test::TemporaryFolder folder;
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(written(folder).string(), 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1U);
  const aiMesh& mesh = *scene->mMeshes[0];
  ASSERT_EQ(mesh.mNumVertices, 3U);
  ASSERT_EQ(mesh.mNumFaces, 1U);
  const aiVector3D last = mesh.mVertices[2];  // (x, y, z), z up, is (x, z, -y)
  EXPECT_EQ(last, aiVector3D(1, 5, -2));
  EXPECT_EQ(mesh.mNormals[0], aiVector3D(0, 0, 1));
  EXPECT_EQ(mesh.mTextureCoords[0][2], aiVector3D(0, 0.75F, 0));  // assimp's v grows upwards
  ASSERT_EQ(scene->mNumTextures, 1U);
  EXPECT_EQ(scene->mTextures[0]->CheckFormat("png"), true);
#else
  GTEST_SKIP() << "assimp is not installed: scripts/setup peers installs it";
#endif
}

TEST(GlbWriter, LinesAreReadByAnotherLibrary) {
#ifdef MIXRIG_HAS_ASSIMP
  const test::TemporaryFolder folder;
  const auto path = folder / "lines.glb";
  ASSERT_TRUE(write_glb(
      {{"person 1", {{1, 2, 0}, {2, 2, 0}, {2, 3, 0}}}, {"person 2", {{0, 0, 0}, {0, 5, 0}}}},
      path));
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 2U);
  ASSERT_EQ(scene->mMeshes[0]->mNumVertices, 3U);
  EXPECT_EQ(scene->mMeshes[0]->mNumFaces, 2U);
  EXPECT_EQ(scene->mMeshes[0]->mPrimitiveTypes & aiPrimitiveType_LINE,
            static_cast<unsigned>(aiPrimitiveType_LINE));
  EXPECT_EQ(scene->mMeshes[1]->mVertices[1], aiVector3D(0, 0, -5));
#else
  GTEST_SKIP() << "assimp is not installed: scripts/setup peers installs it";
#endif
}

}  // namespace
}  // namespace mixrig::scene
