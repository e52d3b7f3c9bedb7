// SPDX-License-Identifier: Apache-2.0
// Numbers of a mesh that KHR_mesh_quantization and KHR_texture_transform change, and morph targets,
// against values worked out by hand.
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

const std::string kPositions = floats({0, 0, 0, 1, 0, 0, 0, 2, 0});

class GltfShape : public ::testing::Test {
 protected:
  Result<Model> load(const std::string& bytes) { return load_gltf(folder_.write("m.glb", bytes)); }
  test::TemporaryFolder folder_;
};

void expect_near(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  EXPECT_LT((a - b).norm(), 1e-5F) << a.transpose() << " is not " << b.transpose();
}

/// A square of 200 mm by the four kinds of numbers of KHR_mesh_quantization, scaled by its node.
TEST_F(GltfShape, QuantizedMeshesAreReadInEachOfTheirTypes) {
  struct Kind {
    int type;
    bool normalized;
    double largest;  ///< what stands for 1
    bool is_signed;
  };
  for (const Kind& kind :
       {Kind{5120, true, 127, true}, Kind{5121, true, 255, false}, Kind{5122, true, 32767, true},
        Kind{5123, true, 65535, false}, Kind{5120, false, 100, true}, Kind{5122, false, 5000, true},
        Kind{5121, false, 200, false}, Kind{5123, false, 40000, false}}) {
    const int size = kind.type < 5122 ? 1 : 2, top = static_cast<int>(kind.largest);
    std::string bytes;
    for (const int value : {0, 0, 0, 0, top, 0, 0, 0, 0, top, 0, 0}) {  // padded to four
      bytes += static_cast<char>(value & 255);
      if (size == 2) bytes += static_cast<char>(value >> 8);
    }
    const double scale = 0.2 / (kind.normalized ? 1 : kind.largest);
    const std::string text =
        R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"scale":[)" + std::to_string(scale) +
        R"(,1,)" + std::to_string(scale) +
        R"(]}],"extensionsRequired":["KHR_mesh_quantization"],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":)" +
        std::to_string(bytes.size()) + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" +
        std::to_string(bytes.size()) + R"(,"byteStride":)" + std::to_string(4 * size) +
        R"(}],"accessors":[{"bufferView":0,"componentType":)" + std::to_string(kind.type) +
        R"(,"normalized":)" + (kind.normalized ? "true" : "false") +
        R"(,"count":3,"type":"VEC3"}]})";
    const auto model = load(glb(text, bytes));
    ASSERT_TRUE(model) << kind.type << ": " << model.error().context;
    const Bounds box = bounds(*model);
    EXPECT_NEAR(box.max_m.x(), 0.2, 1e-3) << kind.type;  // to_string() has six digits
    EXPECT_EQ(box.min_m.x(), 0) << kind.type;
  }
  // Normalised: the two lowest numbers are both -1.
  const std::string text = R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":12}],
    "bufferViews":[{"buffer":0,"byteLength":12,"byteStride":4}],
    "accessors":[{"bufferView":0,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"}]})";
  const auto model = load(glb(text, std::string("\x80\0\0\0\x81\x7f\0\0\0\0\0\0", 12)));
  ASSERT_TRUE(model) << model.error().context;
  expect_near(model->meshes[0].positions_m[0], {-1, 0, 0});
  expect_near(model->meshes[0].positions_m[1], {-1, 0, 1});
}

/// Half of the first target and none of the second, by the mesh or by its node.
TEST_F(GltfShape, MorphWeightsShapeTheMeshAtRest) {
  const std::string moves = floats({0, 0, 4, 0, 0, 0, 0, 2, 0}), far = floats({9, 9, 9});
  const auto text = [](const std::string& node, const std::string& weights) {
    return R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0)" + node +
           R"(}],"meshes":[{"weights":[)" + weights +
           R"(],"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":1},{"POSITION":2}]}]}],
    "buffers":[{"byteLength":84}],"bufferViews":[{"buffer":0,"byteLength":36},
      {"buffer":0,"byteOffset":36,"byteLength":36},{"buffer":0,"byteOffset":72,"byteLength":12}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
      {"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"},
      {"bufferView":2,"componentType":5126,"count":1,"type":"VEC3"}]})";
  };
  const std::string bytes = kPositions + moves + far;
  for (const auto& [node, weights] : {std::pair("", "0.5,0"), {R"(,"weights":[0.5,0])", "1,1"}}) {
    const auto model = load(glb(text(node, weights), bytes));
    ASSERT_TRUE(model) << model.error().context;
    expect_near(model->meshes[0].positions_m[0], {0, -2, 0});
    expect_near(model->meshes[0].positions_m[2], {0, 0, 3});
  }
  EXPECT_TRUE(test::refused(load(glb(text("", "0,1"), bytes)), {"differ in length"}));
}

/// The first example of the extension's text: the lower left quarter of the picture, turned.
TEST_F(GltfShape, TextureTransformsMoveTheCoordinates) {
  const auto file = [&](const std::string& color, const std::string& normal) {
    const std::string png = test::hand_png(1, 1, 8, 2, test::bytes_of({0, 10, 20, 30}));
    const std::string text =
        R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"extensionsRequired":["KHR_texture_transform"],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2},"material":0}]}],
    "materials":[{"name":"paint","pbrMetallicRoughness":{"baseColorTexture":{"index":0)" +
        color + R"(}},"normalTexture":{"index":0)" + normal +
        R"(}}],"textures":[{"source":0}],"images":[{"bufferView":3,"mimeType":"image/png"}],
    "buffers":[{"byteLength":)" +
        std::to_string(84 + png.size()) + R"(}],
    "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},
      {"buffer":0,"byteOffset":60,"byteLength":24},{"buffer":0,"byteOffset":84,"byteLength":)" +
        std::to_string(png.size()) + R"(}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
      {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},
      {"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}]})";
    return glb(text, kPositions + floats({0, 0, 1, 0, 0, 1}) + floats({1, 1, 1, 1, 1, 1}) + png);
  };
  const std::string turned = R"(,"extensions":{"KHR_texture_transform":{"offset":[0,1],
      "rotation":1.57079632679,"scale":[0.5,0.5]}})";
  const auto model = load(file(turned, turned));
  ASSERT_TRUE(model) << model.error().context;
  const auto& uv = model->meshes[0].uv;
  ASSERT_EQ(uv.size(), 3U);
  EXPECT_LT((uv[0] - Eigen::Vector2f(0, 1)).norm(), 1e-6F) << uv[0].transpose();
  EXPECT_LT((uv[1] - Eigen::Vector2f(0, 0.5F)).norm(), 1e-6F) << uv[1].transpose();
  EXPECT_LT((uv[2] - Eigen::Vector2f(0.5F, 1)).norm(), 1e-6F) << uv[2].transpose();

  const std::string other = R"(,"extensions":{"KHR_texture_transform":{"texCoord":1}})";
  const auto second = load(file(other, other));
  ASSERT_TRUE(second) << second.error().context;
  EXPECT_EQ(second->meshes[0].uv[0], Eigen::Vector2f(1, 1));
  EXPECT_TRUE(test::refused(load(file(turned, "")),
                            {"material 'paint' use different texture coordinates"}));
  const std::string wild = R"(,"extensions":{"KHR_texture_transform":{"scale":[1e30,1]}})";
  EXPECT_TRUE(test::refused(load(file(wild, wild)), {"material 'paint' is out of range"}));
}

}  // namespace
}  // namespace mixrig::scene
