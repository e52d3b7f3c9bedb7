// SPDX-License-Identifier: Apache-2.0
// Maps written and read back; files that are damaged.
#include "extras/map/reconstruction/maps/map_file.h"

#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace mixrig {
namespace {

namespace fs = std::filesystem;

reconstruction::LearnedMap small_map() {
  reconstruction::LearnedMap map;
  map.camera = "target", map.calibration_hash = "0123456789abcdef";
  map.scale = reconstruction::MapScale{0.01, 77};
  map.pictures = 9, map.residual_px = 0.25;
  map.keys.push_back({1.5, {Eigen::Quaterniond::Identity(), {1, 2, 3}}, {}});
  map.keys[0].grey.reset({4, 3}, 9);
  reconstruction::MapPoint point;
  point.place = {1, -2, 3.25}, point.covariance = 0.5 * Eigen::Matrix3d::Identity();
  point.covariance(0, 1) = point.covariance(1, 0) = 0.125;
  point.views = 4, point.key = 0, point.px = {2.5, 1.25};
  map.points = {point, point};
  reconstruction::MapDescriptor descriptor;
  descriptor.point = 1;
  for (std::size_t i = 0; i < descriptor.values.size(); ++i)
    descriptor.values[i] = static_cast<std::uint8_t>(2 * i);
  map.descriptors = {descriptor};
  map.path = {{1.5, map.keys[0].map_from_camera}};
  return map;
}

TEST(MapFile, ReadsWhatItWrote) {
  const test::TemporaryFolder folder;
  const auto map = small_map();
  ASSERT_TRUE(reconstruction::write_map(map, folder.path() / "map"));
  const auto read = reconstruction::load_map(folder.path() / "map");
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_EQ(read->camera, "target");
  EXPECT_EQ(read->calibration_hash, map.calibration_hash);
  ASSERT_TRUE(read->scale);
  EXPECT_EQ(read->scale->measurements, 77);
  EXPECT_DOUBLE_EQ(read->scale->sigma, 0.01);
  ASSERT_EQ(read->points.size(), 2U);
  EXPECT_EQ(read->points[1].place, map.points[1].place);
  EXPECT_EQ(read->points[1].covariance, map.points[1].covariance);
  EXPECT_EQ(read->points[1].px, map.points[1].px);
  ASSERT_EQ(read->descriptors.size(), 1U);
  EXPECT_EQ(read->descriptors[0].values, map.descriptors[0].values);
  ASSERT_EQ(read->keys.size(), 1U);
  EXPECT_EQ(read->keys[0].grey.row(2)[3], 9);
  EXPECT_EQ(read->keys[0].map_from_camera.translation_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(read->path.size(), 1U);
}

TEST(MapFile, KeepsTheRoomWhoseAxesItHas) {
  const test::TemporaryFolder folder;
  auto map = small_map();
  map.room = reconstruction::RoomAxes{0.0025, 0.001, {}};
  ASSERT_TRUE(reconstruction::write_map(map, folder.path() / "map"));
  auto read = reconstruction::load_map(folder.path() / "map");
  ASSERT_TRUE(read) << read.error().context;
  ASSERT_TRUE(read->room);
  EXPECT_FALSE(read->room->world_from_room);
  EXPECT_NEAR(read->room->sigma_m, 0.0025, 1e-9);
  EXPECT_NEAR(read->room->sigma_rad, 0.001, 1e-7);
  map.room->world_from_room = geometry::Pose{{0, 0, 1, 0}, {1, 2, 3}};
  ASSERT_TRUE(reconstruction::write_map(map, folder.path() / "map"));
  read = reconstruction::load_map(folder.path() / "map");
  ASSERT_TRUE(read && read->room && read->room->world_from_room);
  EXPECT_EQ(read->room->world_from_room->translation_m, Eigen::Vector3d(1, 2, 3));
}

TEST(MapFile, APointsFileCutAnywhereIsRefused) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(reconstruction::write_map(small_map(), folder.path() / "map"));
  std::ifstream file(folder.path() / "map" / "points.bin", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const auto cut = std::as_bytes(std::span(bytes)).first(length);
    EXPECT_FALSE(reconstruction::parse_map_points(cut, 1, "points.bin")) << length;
  }
  EXPECT_TRUE(reconstruction::parse_map_points(std::as_bytes(std::span(bytes)), 1, "points.bin"));
  // The key picture that the points name is not there.
  EXPECT_FALSE(reconstruction::parse_map_points(std::as_bytes(std::span(bytes)), 0, "points.bin"));
}

TEST(MapFile, AFolderWithoutMapSaysWhatToDo) {
  const test::TemporaryFolder folder;
  const auto read = reconstruction::load_map(folder.path());
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().context.find("mixrig learn"), std::string::npos);
}

TEST(MapFile, AFolderOfSomethingElseIsLeftAlone) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "notes.txt") << "mine";
  EXPECT_FALSE(reconstruction::write_map(small_map(), folder.path()));
  EXPECT_TRUE(fs::exists(folder.path() / "notes.txt"));
}

}  // namespace
}  // namespace mixrig
