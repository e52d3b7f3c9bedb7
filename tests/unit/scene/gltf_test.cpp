// SPDX-License-Identifier: Apache-2.0
// glTF models against values worked out by hand, and damaged ones.
#include <random>

#include <gtest/gtest.h>

#include "host/scene/scene.h"
#include "tests/support/hand_gltf.h"
#include "tests/support/hand_png.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::scene {
namespace {

using test::floats;
using test::glb;
using test::shorts;

// One triangle in glTF's x-y plane, facing +z: 36 bytes of positions, 6 of indices.
const std::string kPositions = floats({0, 0, 0, 1, 0, 0, 0, 2, 0});
const std::string kIndices = shorts({0, 1, 2});

std::string json(const std::string& node, const std::string& primitive,
                 const std::string& more = "") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + node +
         R"(],"meshes":[{"primitives":[)" + primitive + R"(]}],"buffers":[{"byteLength":44}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}])" +
         more + "}";
}

const char* const kNode = R"({"mesh":0})";
const char* const kIndexed = R"({"attributes":{"POSITION":0},"indices":1})";

std::string triangle(const std::string& node = kNode, const std::string& primitive = kIndexed,
                     const std::string& more = "") {
  return glb(json(node, primitive, more), kPositions + kIndices);
}

class Gltf : public ::testing::Test {
 protected:
  Result<Model> load(const std::string& bytes) { return load_gltf(folder_.write("m.glb", bytes)); }
  std::string error_of(const std::string& bytes) {
    const auto model = load(bytes);
    return model ? "" : model.error().context;
  }
  test::TemporaryFolder folder_;
};

void expect_near(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  EXPECT_LT((a - b).norm(), 1e-5F) << a.transpose() << " is not " << b.transpose();
}

/// Normal of a triangle by its winding.
Eigen::Vector3f wound(const Mesh& mesh) {
  const auto& p = mesh.positions_m;
  const auto& i = mesh.indices;
  return (p[i[1]] - p[i[0]]).cross(p[i[2]] - p[i[0]]).normalized();
}

TEST_F(Gltf, YUpBecomesZUpAndMissingNormalsAreThoseOfTheFaces) {
  const auto model = load(triangle());
  ASSERT_TRUE(model) << model.error().context;
  ASSERT_EQ(model->meshes.size(), 1U);
  const Mesh& mesh = model->meshes[0];
  ASSERT_EQ(mesh.positions_m.size(), 3U);
  expect_near(mesh.positions_m[1], {1, 0, 0});
  expect_near(mesh.positions_m[2], {0, 0, 2});
  for (const auto& normal : mesh.normals) expect_near(normal, {0, -1, 0});
  expect_near(wound(mesh), {0, -1, 0});
  EXPECT_EQ(mesh.texture, -1);
  expect_near(mesh.base_color, {1, 1, 1});
  const Bounds box = bounds(*model);
  expect_near(box.min_m, {0, 0, 0});
  expect_near(box.max_m, {1, 0, 2});
}

TEST_F(Gltf, NodeTransformsNestAsTranslationRotationScale) {
  // Half a turn about y takes (1,0,0) to (-1,0,0); the parent doubles and lifts by 10.
  const auto model = load(triangle(
      R"({"children":[1],"translation":[0,10,0],"scale":[2,2,2]},{"mesh":0,"rotation":[0,1,0,0],"translation":[0,0,3]})"));
  ASSERT_TRUE(model) << model.error().context;
  // glTF (1,0,0) -> (-1,0,3) -> (-2,10,6), in object axes (-2,-6,10).
  expect_near(model->meshes[0].positions_m[1], {-2, -6, 10});
  expect_near(model->meshes[0].normals[0], {0, 1, 0});
}

TEST_F(Gltf, AMatrixIsColumnMajorAndAMirrorKeepsTheOutside) {
  const auto model = load(triangle(R"({"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]})"));
  ASSERT_TRUE(model) << model.error().context;
  const Mesh& mesh = model->meshes[0];
  EXPECT_EQ(mesh.positions_m.size(), 3U);
  float largest_x = 0;
  for (const auto& p : mesh.positions_m) largest_x = std::max(largest_x, p.x());
  EXPECT_FLOAT_EQ(largest_x, 5.0F);
  expect_near(mesh.normals[0], {0, -1, 0});
  expect_near(wound(mesh), {0, -1, 0});
}

TEST_F(Gltf, NormalsTurnByTheInverseTranspose) {
  // A slanted normal (1,0,1)/sqrt 2 under scale (2,1,1) leans to (0.5,0,1).
  const std::string normals = floats({1, 0, 1, 1, 0, 1, 1, 0, 1});
  const std::string text = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"scale":[2,1,1]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1}}]}],"buffers":[{"byteLength":72}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"}]})";
  const auto model = load(glb(text, kPositions + normals));
  ASSERT_TRUE(model) << model.error().context;
  expect_near(model->meshes[0].normals[0], Eigen::Vector3f(0.5F, -1, 0).normalized());
}

TEST_F(Gltf, StripsAndFansBecomeTrianglesOfOneFacing) {
  const std::string square = floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  const auto text = [](int mode) {
    return R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":)" +
           std::to_string(mode) +
           R"(}]}],"buffers":[{"byteLength":48}],"bufferViews":[{"buffer":0,"byteLength":48}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}]})";
  };
  const auto strip = load(glb(text(5), square));
  ASSERT_TRUE(strip) << strip.error().context;
  EXPECT_EQ(strip->meshes[0].indices.size(), 6U);
  for (const auto& normal : strip->meshes[0].normals) expect_near(normal, {0, -1, 0});
  const std::string round = floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  const auto fan = load(glb(text(6), round));
  ASSERT_TRUE(fan) << fan.error().context;
  EXPECT_EQ(fan->meshes[0].indices.size(), 6U);
  for (const auto& normal : fan->meshes[0].normals) expect_near(normal, {0, -1, 0});
  EXPECT_NE(error_of(glb(text(1), square)).find("points or lines"), std::string::npos);
}

TEST_F(Gltf, BaseColourIsLinearAndThePictureLiesBesideTheModel) {
  const std::string uv = floats({0, 0, 1, 0, 0, 1});
  const std::string text = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.25,0.5,1,1],"baseColorTexture":{"index":0}},"doubleSided":true}],
    "textures":[{"source":0}],"images":[{"uri":"paint%20me.png"}],
    "buffers":[{"byteLength":60,"uri":"m.bin"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}]})";
  const auto path = folder_.write("m.gltf", text);
  folder_.write("m.bin", kPositions + uv);
  EXPECT_TRUE(test::refused(load_gltf(path), {"picture 'paint%20me.png' is missing"}));
  folder_.write("paint me.png", test::hand_png(1, 1, 8, 2, test::bytes_of({0, 10, 20, 30})));
  const auto model = load_gltf(path);
  ASSERT_TRUE(model) << model.error().context;
  const Mesh& mesh = model->meshes[0];
  expect_near(mesh.base_color, {0.25F, 0.5F, 1.0F});
  EXPECT_TRUE(mesh.double_sided);
  ASSERT_EQ(mesh.texture, 0);
  EXPECT_EQ(model->textures[0].at(0, 0), (Rgb8{10, 20, 30}));
  EXPECT_EQ(mesh.uv[2], Eigen::Vector2f(0, 1));
}

/// A triangle with maps, whose materials are `materials`.
std::string mapped(const std::string& materials) {
  return R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":1},"material":0}]}],
    "materials":[)" +
         materials + R"(],"textures":[{"source":0},{"source":1},{"source":0}],
    "images":[{"uri":"a.png"},{"uri":"b.png"}],"buffers":[{"byteLength":60,"uri":"m.bin"}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}]})";
}

TEST_F(Gltf, GlossLightOfItsOwnAndMapsAreRead) {
  folder_.write("m.bin", kPositions + floats({0, 0, 1, 0, 0, 1}));
  folder_.write("a.png", test::hand_png(1, 1, 8, 2, test::bytes_of({0, 10, 20, 30})));
  folder_.write("b.png", test::hand_png(1, 1, 8, 2, test::bytes_of({0, 128, 128, 255})));
  const auto model = load_gltf(folder_.write("m.gltf", mapped(R"({
    "pbrMetallicRoughness":{"metallicFactor":0.5,"roughnessFactor":0.25,"metallicRoughnessTexture":{"index":0}},
    "normalTexture":{"index":1,"scale":0.5},"emissiveTexture":{"index":2},"emissiveFactor":[0.1,0.2,0.5],
    "extensions":{"KHR_materials_specular":{"specularFactor":0.75},
                  "KHR_materials_emissive_strength":{"emissiveStrength":4}}})")));
  ASSERT_TRUE(model) << model.error().context;
  const Mesh& mesh = model->meshes[0];
  EXPECT_EQ(mesh.metallic, 0.5F);
  EXPECT_EQ(mesh.roughness, 0.25F);
  EXPECT_EQ(mesh.specular, 0.75F);
  EXPECT_EQ(mesh.normal_scale, 0.5F);
  expect_near(mesh.emission, {0.4F, 0.8F, 1});  // no brighter than white
  EXPECT_EQ(mesh.texture, -1);
  EXPECT_EQ(mesh.gloss_map, 0);
  EXPECT_EQ(mesh.normal_map, 1);
  EXPECT_EQ(mesh.emission_map, 0) << "the same picture is read once";
  EXPECT_EQ(mesh.uv.size(), 3U);
}

TEST_F(Gltf, GlossIsThatOfTheFormatWhereAMaterialSaysNothing) {
  folder_.write("m.bin", kPositions + floats({0, 0, 1, 0, 0, 1}));
  const auto model = load_gltf(folder_.write("m.gltf", mapped("{}")));
  ASSERT_TRUE(model) << model.error().context;
  EXPECT_EQ(model->meshes[0].metallic, 1);
  EXPECT_EQ(model->meshes[0].roughness, 1);
  EXPECT_EQ(model->meshes[0].specular, 1);
  expect_near(model->meshes[0].emission, {0, 0, 0});
}

/// 16384 x 16384 pixels in a file of 100 bytes.
TEST_F(Gltf, PicturesThatWouldFillTheMemoryAreRefusedByTheirHeaders) {
  folder_.write("m.bin", kPositions + floats({0, 0, 1, 0, 0, 1}));
  const auto path = folder_.write(
      "m.gltf", mapped(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})"));
  folder_.write("a.png", test::hand_png(16384, 16384, 8, 2, ""));
  folder_.write("b.png", test::hand_png(1, 1, 8, 2, test::bytes_of({0, 10, 20, 30})));
  EXPECT_TRUE(test::refused(load_gltf(path), {"its pictures have more than 268 million pixels"}));
}

TEST_F(Gltf, MeshesThatManyNodesUseCountEachTime) {
  std::string nodes = kNode, list = "0";
  const int triangles = 2000, uses = 10'001;
  for (int i = 1; i < uses; ++i) nodes += std::string(",") + kNode, list += "," + std::to_string(i);
  std::string indices;
  for (int i = 0; i < triangles; ++i) indices += kIndices;
  const std::string bytes = std::to_string(36 + indices.size());
  EXPECT_NE(
      error_of(
          glb(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[)" + list + R"(]}],"nodes":[)" +
                  nodes + R"(],"meshes":[{"primitives":[)" + kIndexed +
                  R"(]}],"buffers":[{"byteLength":)" + bytes +
                  R"(}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,
                       "byteLength":)" +
                  std::to_string(indices.size()) +
                  R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                       {"bufferView":1,"componentType":5123,"type":"SCALAR","count":)" +
                  std::to_string(3 * triangles) + "}]}",
              kPositions + indices))
          .find("20 million vertices or triangles"),
      std::string::npos);
}

TEST_F(Gltf, MapsWithDifferentTextureCoordinatesAreRefused) {
  folder_.write("m.bin", kPositions + floats({0, 0, 1, 0, 0, 1}));
  const auto model = load_gltf(folder_.write("m.gltf", mapped(R"({"name":"paint",
    "pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"normalTexture":{"index":1,"texCoord":1}})")));
  EXPECT_TRUE(test::refused(model, {"material 'paint' use different texture coordinates"}));
}

TEST_F(Gltf, AMissingBufferIsNamedAndNoFileOutsideTheFolderIsRead) {
  folder_.write("secret.bin", kPositions + kIndices + "xx");
  for (const char* uri : {"none.bin", "../secret.bin", "/etc/passwd", "..%2Fsecret.bin"}) {
    std::string text = json(kNode, kIndexed);
    const std::string length = "{\"byteLength\":44";
    text.replace(text.find(length), length.size(), length + ",\"uri\":\"" + uri + "\"");
    EXPECT_TRUE(test::refused(load_gltf(folder_.write("inner/m.gltf", text)), {"inner/m.gltf"}))
        << uri;
  }
}

TEST_F(Gltf, WhatIsWrongIsReportedInOneLine) {
  const auto with = [](std::string from, std::string to) {
    std::string text = json(kNode, kIndexed);
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return glb(text.replace(at, from.size(), to), kPositions + kIndices);
  };
  EXPECT_NE(error_of(glb(json(kNode, kIndexed), kPositions + shorts({0, 1, 7})))
                .find("index is out of range"),
            std::string::npos);
  EXPECT_NE(error_of(with("\"count\":3", "\"count\":4")).find("reaches past its buffer"),
            std::string::npos);
  EXPECT_NE(error_of(with("\"count\":3", "\"count\":4000000000")).find("reaches past its buffer"),
            std::string::npos);
  EXPECT_NE(
      error_of(with("\"byteLength\":36", "\"byteLength\":3600")).find("reaches past its buffer"),
      std::string::npos);
  EXPECT_NE(error_of(with("\"buffer\":0", "\"buffer\":7")).find("names a missing buffer"),
            std::string::npos);
  EXPECT_NE(error_of(with("5126", "5125")).find("holds neither floats nor bytes nor shorts"),
            std::string::npos);
  EXPECT_NE(error_of(triangle(R"({"mesh":9})")).find("mesh 9 does not exist"), std::string::npos);
  EXPECT_NE(error_of(triangle(R"({"mesh":0,"children":[0]})")).find("not a tree"),
            std::string::npos);
  EXPECT_NE(error_of(triangle(R"({"name":"empty"})")).find("has no triangles"), std::string::npos);
  EXPECT_NE(
      error_of(triangle(kNode, kIndexed, R"(,"extensionsRequired":["KHR_draco_mesh_compression"])"))
          .find("KHR_draco"),
      std::string::npos);
  EXPECT_NE(error_of(glb(json(kNode, kIndexed), floats({0, 0, 0, NAN, 0, 0, 0, 1, 0}) + kIndices))
                .find("not finite"),
            std::string::npos);
  EXPECT_NE(error_of(glb("{\"a\":" + std::string(100000, '[') + "}", "")).find("nested too deep"),
            std::string::npos);
  EXPECT_NE(error_of("").find("m.glb"), std::string::npos);
  EXPECT_EQ(load_gltf(folder_ / "none.glb").error().code, ErrorCode::kNotFound);
}

TEST_F(Gltf, SparseAccessorsAreRefusedWithWhatToDo) {
  std::string text = json(kNode, kIndexed);
  const std::string from = "\"type\":\"VEC3\"";
  text.replace(
      text.find(from), from.size(),
      from +
          R"(,"sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}})");
  EXPECT_NE(error_of(glb(text, kPositions + kIndices)).find("export without sparse accessors"),
            std::string::npos);
}

TEST_F(Gltf, CutAndChangedFilesNeverCrash) {
  const std::string whole = triangle();
  for (std::size_t length = 0; length < whole.size(); length += 3)
    EXPECT_FALSE(load(whole.substr(0, length))) << length;
  std::mt19937 random(7);
  for (int i = 0; i < 500; ++i) {
    std::string bytes = whole;
    for (int flips = 0; flips < 2; ++flips)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    if (const auto model = load(bytes); model) {
      EXPECT_FALSE(model->meshes.empty());
    }
  }
}

}  // namespace
}  // namespace mixrig::scene
