// SPDX-License-Identifier: Apache-2.0
// A room is scanned, then a hand-held camera is tracked in it by its fisheye: `mixrig track`, and
// `mixrig run` with pose = "tracker". The bounds were chosen on seeds 5 and 6; the test uses seed
// 33.
#include <fstream>

#include "host/math/image_io/image_io.h"
#include "tests/e2e/command.h"
#include "tests/e2e/tracked_scene.h"

namespace mixrig::test {
namespace {

class TrackedRun : public TrackedTake {
 protected:
  static constexpr int kFrames = 30;

  void SetUp() override {
    CommandTest::SetUp();
    ASSERT_NO_FATAL_FAILURE(make_room_and_take(kFrames));
  }

  static std::string with_latency(std::string scene) {
    const std::string tracker = "pose = \"tracker\"";
    return scene.replace(scene.find(tracker), tracker.size(), tracker + "\nsmooth_ms = 200");
  }
};

TEST_F(TrackedRun, FollowsAHandHeldCamera) {
  const std::string of_take = "track --model " + path("room") + " --take " + path("take") + " ";
  EXPECT_NE(refusal(of_take + path("path.tum")).find("give its calibration.toml"),
            std::string::npos);
  EXPECT_NE(refusal("track --model " + path("room")).find("--model needs --take"),
            std::string::npos);
  EXPECT_NE(refusal(of_take + "--calibration " + path("sweep/truth/calibration.toml") +
                    " --scene " + path("take/scene.toml"))
                .find("does not say where the room stands"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path("path.tum")));
  ASSERT_EQ(mixrig(of_take + "--calibration " + path("take/truth/calibration.toml") + " --scene " +
                   path("sweep/scene_pan_tilt.toml") + " " + path("path.tum") + " --json " +
                   path("track.json")),
            0);
  const auto tracked = report("track.json");
  EXPECT_EQ(tracked.at("frames").get<int>(), 12);  // 10 Hz
  EXPECT_EQ(tracked.at("lost_pct").get<double>(), 0);
  EXPECT_EQ(tracked.at("searches").get<int>(), 1);
  EXPECT_LT(tracked.at("rms_mm").get<double>(), 4);
  EXPECT_LT(tracked.at("rms_deg").get<double>(), 0.08);
  EXPECT_TRUE(std::filesystem::exists(path("path.tum")));

  std::ofstream(path("take/scene_tracker.toml"))
      << tracker_scene(path("take"), path("room"), world_from_base(path("sweep")));
  ASSERT_EQ(mixrig("run " + path("take/scene_tracker.toml") + " --source take:" + path("take") +
                   " --frames 5-30 --out " + path("out") + " --json " + path("run.json")),
            0);
  const auto pose = report("run.json").at("pose");
  EXPECT_EQ(pose.at("source").get<std::string>(), "tracker");
  EXPECT_EQ(pose.at("lost").get<int>(), 0);
  EXPECT_EQ(pose.at("latency_s").get<double>(), 0);
  EXPECT_LT(pose.at("error").at("shift_mm").at("rms").get<double>(), 4);
  EXPECT_LT(pose.at("slip_px").at("rms").get<double>(), 0.5);

  std::ofstream(path("take/scene_smooth.toml"))
      << with_latency(tracker_scene(path("take"), path("room"), world_from_base(path("sweep"))));
  ASSERT_EQ(mixrig("run " + path("take/scene_smooth.toml") + " --source take:" + path("take") +
                   " --frames 5-30 --json " + path("smooth.json")),
            0);
  const auto smooth = report("smooth.json").at("pose");
  EXPECT_EQ(smooth.at("frames").get<int>(), 26) << "those that were held come too";
  EXPECT_EQ(smooth.at("latency_s").get<double>(), 0.2);
  const auto turn_deg = [](const auto& run) {
    return run.at("error").at("turn_deg").at("rms").template get<double>();
  };
  EXPECT_LT(turn_deg(smooth), turn_deg(pose)) << "pictures after a plate tell more than velocity";
}

TEST_F(TrackedRun, IsFoundAgainInTheFirstPictureAfterTheLensWasCovered) {
  for (int picture = 5; picture <= 7; ++picture)
    ASSERT_TRUE(image_io::write_png(path("take/fisheye/00000" + std::to_string(picture) + ".png"),
                                    Image<Rgb8>({320, 256}).view()));
  ASSERT_EQ(
      mixrig("track --model " + path("room") + " --take " + path("take") + " --calibration " +
             path("take/truth/calibration.toml") + " --scene " + path("sweep/scene_pan_tilt.toml") +
             " " + path("path.tum") + " --json " + path("track.json")),
      0);
  const auto tracked = report("track.json");
  EXPECT_EQ(tracked.at("frames").get<int>(), 12);
  EXPECT_EQ(tracked.at("lost_pct").get<double>(), 25) << "the three covered ones";
  EXPECT_LT(tracked.at("max_mm").get<double>(), 6);
}

}  // namespace
}  // namespace mixrig::test
