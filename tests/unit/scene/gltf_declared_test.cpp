// SPDX-License-Identifier: Apache-2.0
// What a glTF file says of itself is read, refused by name or told.
#include "host/scene/gltf/gltf_declared.h"

#include <gtest/gtest.h>

#include "host/scene/scene.h"
#include "tests/support/hand_gltf.h"
#include "tests/support/hand_png.h"
#include "tests/support/little_memory.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::scene {
namespace {

/// A triangle with texture coordinates 2; `more` goes to the top, `attributes` to its primitive.
std::string declared(const std::string& more, const std::string& attributes = "") {
  const std::string bytes =
      test::floats({0, 0, 0, 1, 0, 0, 0, 2, 0}) + test::floats({0, 0, 1, 0, 0, 1});
  return test::glb(
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0)" +
          attributes + R"(},"material":0}]}],"buffers":[{"byteLength":60}],
      "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                   {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}])" +
          more + "}",
      bytes);
}

class GltfDeclared : public ::testing::Test {
 protected:
  Result<Model> load(const std::string& bytes, const char* name = "m.glb") {
    return load_gltf(folder_.write(name, bytes));
  }
  Result<std::vector<std::string>> without(const std::string& json) {
    return check_declared(json, {}, {}, folder_.path());
  }
  test::TemporaryFolder folder_;
};

/// The header of a PNG of 16384 x 16384 pixels; two are more than a model may have.
constexpr const char* kLargePng = "iVBORw0KGgoAAAANSUhEUgAAQAAAAEAACAIAAAAmqofTAAAAAElEQVQ1rwYe";

/// The same header behind the letter '7'.
constexpr const char* kSeventhAndLargePng =
    "N4lQTkcNChoKAAAADUlIRFIAAEAAAABAAAgCAAAAJqqH0wAAAABJREFUNa8GHg==";

TEST_F(GltfDeclared, PicturesAreCountedBeforeTheFileIsParsed) {
  const std::string picture = std::string("{\"uri\":\"data:image/png;base64,") + kLargePng + "\"}";
  const auto file = [&](const std::string& pictures) {
    return R"({"asset":{"version":"2.0"},"images":[)" + pictures +
           "]";  // the last brace is missing
  };
  EXPECT_TRUE(test::refused(load(file(picture), "one.gltf"), {"is cut short"}));
  EXPECT_TRUE(
      test::refused(load(file(picture + "," + picture), "two.gltf"), {"more than 268 million"}));
  EXPECT_TRUE(test::refused(load(R"({"asset":"\\\"","images":[)" + picture, "quote.gltf"),
                            {"is cut short"}));
}

TEST_F(GltfDeclared, AModelThatHasNoMemoryIsItsError) {
  if (!kLimitsMemory) GTEST_SKIP() << "memory is not limited under a sanitizer";
  const std::filesystem::path path = folder_.write("large.glb", declared(""));
  std::filesystem::resize_file(path, std::size_t{200} << 20);
  EXPECT_EXIT(test::say_with_little_memory(std::size_t{64} << 20, [&] { return load_gltf(path); }),
              testing::ExitedWithCode(0), "large.glb': no memory is left: stop other programs");
}

/// The buffer is cut short, which only the parser would say.
TEST_F(GltfDeclared, PicturesInTheBufferAreCountedBeforeItIsParsed) {
  const std::string png = test::hand_png(16384, 16384, 8, 2, "");
  const auto file = [&](const char* images) {
    const std::string json = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":999999999}],
        "bufferViews":[{"buffer":0,"byteLength":)" +
                             std::to_string(png.size()) + R"(}, {"buffer":0,"byteOffset":9999999}],
        "images":)" + images +
                             "}";
    return test::glb(json, png);
  };
  EXPECT_TRUE(test::refused(load(file(R"([{"bufferView":0},{"bufferView":0}])")),
                            {"more than 268 million"}));
  EXPECT_TRUE(test::refused(load(file(R"([{"bufferView":0},{"bufferView":1},{"bufferView":2},
                                          {"bufferView":-1},5])")),
                            {"damaged"}));
}

/// The JSON ends too early, or the last file is missing, which only the parser would say.
TEST_F(GltfDeclared, PicturesInFilesAndInTextsOfBuffersAreCountedBeforeTheyAreParsed) {
  const std::string png = test::hand_png(16384, 16384, 8, 2, "");
  folder_.write("large map.png", png);
  folder_.write("b.bin", "1234567" + png);
  const auto file = [&](const std::string& buffer, const std::string& images) {
    return R"({"asset":{"version":"2.0"},"buffers":[)" + buffer +
           R"(],"bufferViews":[{"buffer":0,"byteOffset":7,"byteLength":57},
        {"buffer":0,"byteOffset":9999,"byteLength":57},{"buffer":1}],"images":[)" +
           images + R"(],"nodes":5})";
  };
  const std::string two = R"({"bufferView":0},{"bufferView":0})";
  const std::string none = R"({"bufferView":1},{"bufferView":2},{"uri":"none.png"},{"uri":5})";
  const std::string text =
      R"({"byteLength":64,"uri":"data:application/octet-stream;base64,MTIzNDU2)" +
      std::string(kSeventhAndLargePng) + "\"}";
  const std::string named = R"({"byteLength":64,"uri":"b.bin"})";
  for (const std::string& buffer : {text, named}) {
    EXPECT_TRUE(test::refused(load(file(buffer, two), "m.gltf"), {"more than 268 million"}));
    EXPECT_TRUE(test::refused(load(file(buffer, none), "m.gltf"), {"damaged"}));
  }
  const std::string picture = R"({"uri":"large%20map.png"})";
  EXPECT_TRUE(test::refused(load(file(named, picture + "," + picture), "m.gltf"),
                            {"more than 268 million"}));
  EXPECT_TRUE(test::refused(load(file(named, picture), "m.gltf"), {"damaged"}));
}

TEST_F(GltfDeclared, PicturesValuesAndBytesOfFilesHaveLimits) {
  const auto many = [](const char* one, int count) {
    std::string list = one;
    for (int i = 1; i < count; ++i) list += std::string(",") + one;
    return list;
  };
  EXPECT_TRUE(test::refused(load(declared(R"(,"images":[)" + many("{}", 4097) + "]")),
                            {"has more than 4096 pictures"}));
  EXPECT_TRUE(test::refused(load(declared(R"(,"extras":[)" + many("0", (2 << 20) + 1) + "]")),
                            {"more than 2 million values"}));
  folder_.write("one.png", "1");
  std::filesystem::resize_file(folder_.write("rest.png", "1"), std::uintmax_t{1} << 30);
  EXPECT_TRUE(test::refused(load(declared(R"(,"images":[{"uri":"one.png"},{"uri":"rest.png"}])")),
                            {"files have more than 1 GiB"}));
}

TEST_F(GltfDeclared, OnlyRequiredExtensionsThatAreReadPass) {
  for (const char* name :
       {"KHR_materials_pbrSpecularGlossiness", "KHR_materials_unlit", "KHR_materials_transmission",
        "KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing"})
    EXPECT_TRUE(test::refused(
        load(declared(std::string(R"(,"extensionsRequired":[")") + name + "\"]")),
        {"m.glb", std::string("needs the extension ") + name + ": export without it"}));
  for (const char* name : {"KHR_materials_specular", "KHR_materials_emissive_strength",
                           "KHR_texture_transform", "KHR_mesh_quantization"})
    EXPECT_TRUE(load(declared(std::string(R"(,"extensionsRequired":[")") + name + "\"]"))) << name;
}

/// Draco's accessors have no buffer view, and the fallback buffer of meshopt has no data: both are
/// refused by name before a parser stumbles over them.
TEST_F(GltfDeclared, CompressedModelsAreRefusedByTheirExtension) {
  const std::string draco =
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,
      "extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}}]}],
      "accessors":[{"componentType":5126,"count":24,"type":"VEC3"},
                   {"componentType":5123,"count":36,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteLength":8}],"buffers":[{"byteLength":8}],
      "extensionsRequired":["KHR_draco_mesh_compression"]})";
  EXPECT_TRUE(test::refused(load(test::glb(draco, "12345678")),
                            {"needs the extension KHR_draco_mesh_compression"}));
  const std::string meshopt =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":840,"extensions":
      {"EXT_meshopt_compression":{"fallback":true}}},{"byteLength":8}],
      "extensionsRequired":["EXT_meshopt_compression"]})";
  EXPECT_TRUE(test::refused(load(test::glb(meshopt, "12345678")),
                            {"needs the extension EXT_meshopt_compression"}));
}

TEST_F(GltfDeclared, WhatChangesTheLookAndIsNotReadIsTold) {
  const auto list = without(
      R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_materials_clearcoat","KHR_xmp_json_ld",
      "KHR_materials_specular","KHR_materials_unlit"]})");
  ASSERT_TRUE(list) << list.error().context;
  EXPECT_EQ(*list, (std::vector<std::string>{"KHR_materials_clearcoat", "KHR_materials_unlit"}));
  const auto plain = without(R"({"asset":{"version":"2.0"}})");
  ASSERT_TRUE(plain);
  EXPECT_TRUE(plain->empty());
}

TEST_F(GltfDeclared, OtherFilesAndVersionsAreNamed) {
  EXPECT_TRUE(test::refused(load(R"({"asset":{"version":"1.0"},"scenes":{"s":{}}})", "m.gltf"),
                            {"is glTF 1.0: export it as glTF 2.0"}));
  EXPECT_TRUE(
      test::refused(load(std::string("glTF\1\0\0\0", 8) + std::string(40, ' ')), {"is glTF 1.0"}));
  EXPECT_TRUE(test::refused(load("# made by hand\nv 0 0 0\n", "m.obj"), {"is no glTF file: use"}));
  EXPECT_TRUE(test::refused(load("ply\nformat ascii 1.0\n", "m.ply"), {"is no glTF file: use"}));
  EXPECT_TRUE(test::refused(load(R"({"asset":{"version":"2.0")", "m.gltf"), {"is cut short"}));
  EXPECT_TRUE(test::refused(load(R"({"nodes":[]})", "m.gltf"), {"names no version"}));
}

TEST_F(GltfDeclared, APictureWithoutCoordinatesOrInAnotherFormatIsNamedByItsMaterial) {
  const std::string paint =
      R"(,"materials":[{"name":"paint","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
      "images":[{"bufferView":1,"mimeType":"image/png"}],"textures":[)";
  EXPECT_TRUE(
      test::refused(load(declared(paint + R"({"source":0}])")),
                    {"material 'paint' has a picture", "no texture coordinates: unwrap it"}));
  const std::string uv = R"(,"TEXCOORD_0":1)";
  for (const auto& [extension, format] :
       {std::pair("EXT_texture_webp", "WebP"), std::pair("KHR_texture_basisu", "KTX2"),
        std::pair("EXT_texture_avif", "AVIF")})
    EXPECT_TRUE(test::refused(
        load(declared(paint + R"({"extensions":{")" + extension + R"(":{"source":0}}}])", uv)),
        {"the picture of material 'paint' is ", format, extension, "use PNG or JPEG"}))
        << extension;
  EXPECT_TRUE(test::refused(load(declared(paint + "{}]", uv)),
                            {"material 'paint' names a texture without a picture"}));
}

TEST_F(GltfDeclared, AMissingFileIsNamed) {
  EXPECT_TRUE(test::refused(
      load(R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"my%20mesh.bin"}]})",
           "m.gltf"),
      {"needs the file 'my%20mesh.bin'", "copy it there"}));
}

}  // namespace
}  // namespace mixrig::scene
