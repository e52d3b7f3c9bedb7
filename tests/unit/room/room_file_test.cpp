// SPDX-License-Identifier: Apache-2.0
// Room folders: exact, and damaged ones.
#include "host/room/scan/room_file.h"

#include <cmath>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::model {
namespace {

Panorama small_room(int factor) {
  const Size size{8, 4};
  Panorama p{Image<float>(size, 2.345678F), Image<float>(size, 0.0123F),
             Image<std::uint8_t>(size, 3), Image<std::uint8_t>(size, 1),
             Image<Rgb8>({factor * 8, factor * 4}, Rgb8{10, 200, 30})};
  p.distance_m.at(7, 3) = 0;
  p.views.at(2, 1) = 0;
  p.color.at(1, 1) = {1, 2, 3};
  p.measured_share = 0.5, p.known_share = 0.75;
  return p;
}

class RoomFileTest : public testing::Test {
 protected:
  void write(int factor = 2) {
    const RoomManifest manifest{21, 84, 1234, 0.0015, "0123abcd", {0.25, -0.125}, {}, 0.004};
    ASSERT_TRUE(write_room(small_room(factor), manifest, folder_.path()));
  }
  std::string refusal() const {
    const auto read = load_room(folder_.path());
    return read ? "accepted" : read.error().context;
  }
  /// Replaces a line of the manifest.
  void put(const std::string& key, const std::string& value) {
    std::string text = test::read_bytes(folder_ / "manifest.toml");
    const std::size_t at = text.find(key + " = ");
    ASSERT_NE(at, std::string::npos) << text;
    text.replace(at, text.find('\n', at) - at, key + " = " + value);
    folder_.write("manifest.toml", text);
  }
  test::TemporaryFolder folder_;
};

TEST_F(RoomFileTest, ComesBackExactly) {
  EXPECT_FALSE(is_room(folder_.path()));
  for (const int factor : {1, 2, 8}) {
    write(factor);
    EXPECT_TRUE(is_room(folder_.path()));
    const auto read = load_room(folder_.path());
    ASSERT_TRUE(read) << read.error().context;
    const Panorama& p = read->panorama;
    EXPECT_EQ(p.size(), (Size{8, 4}));
    EXPECT_EQ(p.distance_m.at(0, 0), 2.345678F);
    EXPECT_EQ(p.distance_m.at(7, 3), 0);
    EXPECT_EQ(p.field.at(0, 0), 1);
    EXPECT_EQ(p.field.at(7, 3), 0);
    EXPECT_EQ(p.sigma_m.at(5, 2), 0.0123F);
    EXPECT_EQ(p.views.at(0, 0), 3);
    EXPECT_EQ(p.views.at(2, 1), 0);
    EXPECT_EQ(p.color.size(), (Size{factor * 8, factor * 4}));
    EXPECT_EQ(p.color.at(1, 1), (Rgb8{1, 2, 3}));
    EXPECT_DOUBLE_EQ(p.measured_share, 0.5);
    EXPECT_DOUBLE_EQ(p.known_share, 0.75);
    EXPECT_EQ(read->manifest.views, 21);
    EXPECT_EQ(read->manifest.frames, 84);
    EXPECT_EQ(read->manifest.triangles, 1234);
    EXPECT_DOUBLE_EQ(read->manifest.mesh_tolerance_m, 0.0015);
    EXPECT_EQ(read->manifest.calibration_hash, "0123abcd");
    EXPECT_EQ(read->manifest.vignetting, (geometry::Vignetting{0.25, -0.125}));
    EXPECT_DOUBLE_EQ(read->manifest.distance_sigma, 0.004);
    EXPECT_EQ(read_manifest(folder_.path())->vignetting, read->manifest.vignetting);
  }
}

TEST_F(RoomFileTest, ManifestsThatCannotBeAreRefusedWithLineAndKey) {
  EXPECT_NE(refusal().find("manifest.toml"), std::string::npos) << "there is none";
  const std::pair<const char*, const char*> wrong[] = {
      {"format", "2"},          {"projection", "\"cube\""},
      {"origin", "\"head\""},   {"size_px", "[8, 5]"},
      {"size_px", "[6, 3]"},    {"size_px", "[1e9, 5e8]"},
      {"views", "0"},           {"frames", "-1"},
      {"fill_pct", "101"},      {"triangles", "\"many\""},
      {"vignetting", "[0, 7]"}, {"distance_sigma_pct", "-1"}};
  for (const auto& [key, value] : wrong) {
    write();
    put(key, value);
    EXPECT_NE(refusal().find(std::string("manifest.toml:")), std::string::npos) << key << value;
    EXPECT_NE(refusal().find(key), std::string::npos) << refusal();
  }
  write();
  folder_.write("manifest.toml", "format = ");
  EXPECT_NE(refusal().find("manifest.toml:1"), std::string::npos);
}

TEST_F(RoomFileTest, PicturesThatDoNotFitAreRefused) {
  write();
  put("size_px", "[16, 8]");
  EXPECT_NE(refusal().find("room.exr' has another size"), std::string::npos) << refusal();
  write();
  ASSERT_TRUE(image_io::write_png(folder_ / "color.png", Image<Rgb8>(Size{9, 4}).view()));
  EXPECT_NE(refusal().find("color.png' is not one to eight times"), std::string::npos);
  write();
  Image<float> broken({8, 4}, 1.0F);
  broken.at(3, 3) = std::nanf("");
  ASSERT_TRUE(image_io::write_exr(folder_ / "room.exr", {{"distance_m", broken},
                                                         {"sigma_m", Image<float>({8, 4})},
                                                         {"views", Image<float>({8, 4})}}));
  EXPECT_NE(refusal().find("negative or not finite"), std::string::npos);
  ASSERT_TRUE(image_io::write_exr(folder_ / "room.exr", {{"Z", Image<float>({8, 4})}}));
  EXPECT_NE(refusal().find("no channel distance_m"), std::string::npos);
  write();
  folder_.write("room.exr", test::read_bytes(folder_ / "room.exr").substr(0, 200));
  EXPECT_NE(refusal().find("room.exr"), std::string::npos);
  write();
  std::filesystem::remove(folder_ / "color.png");
  EXPECT_NE(refusal().find("color.png"), std::string::npos);
}

}  // namespace
}  // namespace mixrig::model
