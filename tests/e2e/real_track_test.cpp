// SPDX-License-Identifier: Apache-2.0
// `mixrig track --model` on real pictures. A room is scanned from every second frame of a Kinect in
// a kitchen, and the frames between are tracked in it. The pictures are blurred and their depth is
// not registered to colour; the error of the published poses is one to two centimetres.
#include <numbers>

#include "host/math/image_io/image_io.h"
#include "host/pose/trajectory/trajectory.h"
#include "tests/e2e/real_take.h"

namespace mixrig::test {
namespace {

using RealTrack = RealTakeTest;

TEST_F(RealTrack, AKinectIsFoundInItsKitchen) {
  write_kitchen("known", 0, 2);
  const auto published = write_kitchen("unseen", 1, 2);
  ASSERT_EQ(mixrig("scan --take " + path("known/take.toml") + " " + path("room")), 0);
  ASSERT_EQ(mixrig("track --model " + path("room") + " --take " + path("unseen/take.toml") +
                   " --camera target " + path("path.tum") + " --draw " + path("drawn") +
                   " --json " + path("track.json")),
            0);
  EXPECT_EQ(report("track.json").at("frames").get<int>(), 6);
  EXPECT_EQ(report("track.json").at("lost_pct").get<double>(), 0);
  EXPECT_TRUE(std::filesystem::exists(path("drawn/000006.png")));
  const auto tracked = trajectory::read_samples(path("path.tum"));
  ASSERT_TRUE(tracked) << tracked.error().context;
  ASSERT_EQ(tracked->size(), published.size());
  double squares_mm2 = 0, most_deg = 0;
  for (std::size_t i = 0; i < published.size(); ++i) {
    const geometry::Pose& pose = (*tracked)[i].world_from_body;
    squares_mm2 += 1e6 * (pose.translation_m - published[i].translation()).squaredNorm();
    most_deg = std::max(
        most_deg, 180 / std::numbers::pi *
                      pose.rotation.angularDistance(Eigen::Quaterniond(published[i].linear())));
  }
  EXPECT_LT(std::sqrt(squares_mm2 / static_cast<double>(published.size())), 25);
  EXPECT_LT(most_deg, 1);
}

/// The 15 pictures of a fisheye show an office that was not scanned.
TEST_F(RealTrack, AFisheyeInAnotherRoomIsLostInEveryPicture) {
  write_kitchen("kitchen", 0, 1);
  ASSERT_EQ(mixrig("scan --take " + path("kitchen/take.toml") + " " + path("room")), 0);
  write_office("office");
  EXPECT_NE(
      std::system((std::string(MIXRIG_COMMAND) + " track --model " + path("room") + " --take " +
                   path("office/take.toml") + " --calibration " + path("office.toml") + " --draw " +
                   path("drawn") + " " + path("path.tum") + " >" + path("said") + " 2>&1")
                      .c_str()),
      0);
  std::ifstream file(path("said"));
  const std::string said(std::istreambuf_iterator<char>(file), {});
  EXPECT_NE(said.find("15 pictures, 100.0 % without a pose"), std::string::npos) << said;
  EXPECT_NE(said.find("the room explains none of its pictures"), std::string::npos) << said;
  EXPECT_FALSE(std::filesystem::exists(path("path.tum")));
  EXPECT_TRUE(std::filesystem::exists(path("drawn/000015.png")));
}

}  // namespace
}  // namespace mixrig::test
