// SPDX-License-Identifier: Apache-2.0
// Manifests of joined rooms: as written, and damaged ones.
#include <gtest/gtest.h>

#include "host/room/scan/room_file.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::model {
namespace {

class JoinedFileTest : public testing::Test {
 protected:
  void write(const std::string& second) {
    const Size size{8, 4};
    const Panorama p{Image<float>(size, 2.5F), Image<float>(size, 0.01F),
                     Image<std::uint8_t>(size, 3), Image<std::uint8_t>(size, 1),
                     Image<Rgb8>(size, Rgb8{10, 200, 30})};
    for (const char* name : {"room_1", "room_2"}) {
      std::filesystem::create_directory(folder_ / name);
      ASSERT_TRUE(write_room(p, {21, 84, 12, 0.001, ""}, folder_ / name));
    }
    JoinedPlace there{second, {}, 0.002, 0.01};
    there.first_from_base.translation_m = {1, 2, 3};
    const std::vector<JoinedPlace> places{{"room_1", {}}, there};
    ASSERT_TRUE(write_joined(places, 7, folder_.path()));
  }
  test::TemporaryFolder folder_;
};

TEST_F(JoinedFileTest, ComesBack) {
  write("room_2");
  EXPECT_TRUE(is_room(folder_.path()));
  const auto rooms = load_rooms(folder_.path());
  ASSERT_TRUE(rooms) << rooms.error().context;
  ASSERT_EQ(rooms->size(), 2U);
  EXPECT_EQ((*rooms)[1].first_from_base.translation_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR((*rooms)[1].sigma_m, 0.002, 1e-9);
  const auto one = load_rooms(folder_ / "room_1");
  ASSERT_TRUE(one) << one.error().context;
  EXPECT_EQ(one->size(), 1U);
}

TEST_F(JoinedFileTest, AFolderThatLeadsElsewhereIsRefused) {
  for (const char* second : {"../room_2", "/tmp", "", "."}) {
    write(second);
    EXPECT_FALSE(load_rooms(folder_.path())) << second;
  }
}

TEST_F(JoinedFileTest, AMissingRoomIsRefused) {
  write("room_3");
  EXPECT_FALSE(load_rooms(folder_.path()));
}

}  // namespace
}  // namespace mixrig::model
