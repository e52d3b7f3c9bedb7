// SPDX-License-Identifier: Apache-2.0
// The room.glb of a scan is read by programs that share no code with mixrig: assimp, and Khronos'
// validator if MIXRIG_GLTF_VALIDATOR names the folder of its npm package.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"

#ifdef MIXRIG_HAS_ASSIMP
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#endif

namespace mixrig::test {
namespace {

class RoomGlb : public CommandTest {
 protected:
  nlohmann::json scanned() {
    EXPECT_EQ(studio("take",
                     "--scenario sweep --plain --size 64x48 --rig sr3000 --seed 31 --field 60x40"
                     " --view-frames 1"),
              0);
    EXPECT_EQ(mixrig("scan --take " + path("take") + " --calibration " +
                     path("take/truth/calibration.toml") + " " + path("room") + " --json " +
                     path("room.json")),
              0);
    return report("room.json");
  }
};

#ifdef MIXRIG_HAS_ASSIMP
/// Distance of a point, in glTF axes (y up), from the surface of room.exr in its direction.
double off_m(const Image<float>& distance_m, const aiVector3D& at) {
  const double right = at.x, ahead = -at.z, up = at.y, length = at.Length();
  const double column = 0.5 - std::atan2(-right, ahead) / (2 * M_PI);
  const double row = 0.5 - std::asin(up / length) / M_PI;
  const int x = static_cast<int>(column * distance_m.width()) % distance_m.width();
  const int y = std::clamp(static_cast<int>(row * distance_m.height()), 0, distance_m.height() - 1);
  return std::abs(distance_m.row(y)[x] - length);
}

/// Width and height in the header of a PNG file.
std::array<unsigned, 2> png_size(const unsigned char* bytes) {
  const auto number = [&](int at) {
    return bytes[at] << 24U | bytes[at + 1] << 16U | bytes[at + 2] << 8U | bytes[at + 3];
  };
  return {static_cast<unsigned>(number(16)), static_cast<unsigned>(number(20))};
}
#endif

TEST_F(RoomGlb, IsTheRoomToAssimp) {
#ifdef MIXRIG_HAS_ASSIMP
  const auto scan = scanned();
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path("room/room.glb"), aiProcess_ValidateDataStructure);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1U);
  const aiMesh& mesh = *scene->mMeshes[0];
  EXPECT_EQ(mesh.mNumFaces, scan.at("triangles").get<unsigned>());
  const auto channels = image_io::read_exr(path("room/room.exr"));
  ASSERT_TRUE(channels);
  const auto distance = std::find_if(channels->begin(), channels->end(),
                                     [](const auto& c) { return c.name == "distance_m"; });
  ASSERT_NE(distance, channels->end());
  // Vertices are pixels of the panorama, except those on halved edges.
  unsigned on_surface = 0, inwards = 0;
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    on_surface += off_m(distance->pixels, mesh.mVertices[i]) < 1e-3 ? 1 : 0;
    inwards += mesh.mNormals[i] * mesh.mVertices[i] < 0 ? 1 : 0;
  }
  EXPECT_GT(on_surface, 0.9 * mesh.mNumVertices);
  EXPECT_EQ(inwards, mesh.mNumVertices);
  ASSERT_EQ(scene->mNumTextures, 1U);
  const aiTexture& texture = *scene->mTextures[0];
  ASSERT_TRUE(texture.CheckFormat("png"));
  Image<Rgb8> color;
  ASSERT_TRUE(image_io::read_rgb8(path("room/color.png"), color));
  const auto size = png_size(reinterpret_cast<const unsigned char*>(texture.pcData));
  EXPECT_EQ(size[0], static_cast<unsigned>(color.width()));
  EXPECT_EQ(size[1], static_cast<unsigned>(color.height()));
#else
  GTEST_SKIP() << "assimp is not installed: scripts/setup peers installs it";
#endif
}

TEST_F(RoomGlb, IsSoundToTheValidatorOfKhronos) {
  const char* folder = std::getenv("MIXRIG_GLTF_VALIDATOR");
  if (folder == nullptr)
    GTEST_SKIP() << "MIXRIG_GLTF_VALIDATOR does not name the folder of the npm package "
                    "gltf-validator: npm install gltf-validator";
  scanned();
  const std::string line = "node " + std::string(std::getenv("MIXRIG_SOURCE")) +
                           "/tests/e2e/validate_glb.cjs " + folder + " " + path("room/room.glb") +
                           " >" + path("validated.json");
  ASSERT_EQ(std::system(line.c_str()), 0) << line;
  const auto issues = report("validated.json").at("issues");
  for (const char* kind : {"numErrors", "numWarnings", "numHints"})
    EXPECT_EQ(issues.at(kind).get<int>(), 0) << kind << issues.dump(1);
}

}  // namespace
}  // namespace mixrig::test
