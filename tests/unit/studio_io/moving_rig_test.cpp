// SPDX-License-Identifier: Apache-2.0
// The files beside a moving take are read back by their readers and compared with the take's poses.
#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/take/take.h"
#include "host/pose/trajectory/trajectory.h"
#include "studio/io/studio_source.h"
#include "studio/io/studio_take.h"
#include "tests/support/axes_chain.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::studio_io {
namespace {

namespace fs = std::filesystem;

constexpr double kStep_rad = 0.0514 * M_PI / 180;

studio::StudioOptions options_of(studio::Scenario scenario) {
  studio::StudioOptions options;
  options.scenario = scenario;
  options.rig = studio::RigPreset::kSr3000;
  options.seed = 14;
  options.frames = 4;
  options.size_px = {64, 48};
  options.tolerance = 1;
  options.threads = 1;
  return options;
}

class MovingRig : public ::testing::Test {
 protected:
  void make(studio::Scenario scenario) {
    const auto written =
        write_studio_take(options_of(scenario), take(), take::StreamFormat::kPng, [](int) {});
    ASSERT_TRUE(written) << written.error().context;
  }
  fs::path take() const { return folder_.path() / "take"; }
  nlohmann::json truth() const {
    std::ifstream file(take() / "truth/rig.json");
    return nlohmann::json::parse(file);
  }
  static Eigen::Isometry3d pose_of(const nlohmann::json& j) {
    const auto q = j.at("rotation_xyzw").get<std::vector<double>>();
    const auto t = j.at("translation_m").get<std::vector<double>>();
    return test::isometry({Eigen::Quaterniond(q[3], q[0], q[1], q[2]), {t[0], t[1], t[2]}});
  }

  test::TemporaryFolder folder_;
};

TEST_F(MovingRig, PanHasTicksAndAnglesOfTheHeadAtEveryFrame) {
  make(studio::Scenario::kPan);
  auto studio = studio::Studio::create(options_of(studio::Scenario::kPan));
  auto reader = take::TakeReader::open(take());
  ASSERT_TRUE(reader) << reader.error().context;
  studio::Frame frame;
  capture::Capture capture;
  for (int number = 1; number <= 4; ++number) {
    studio->render(number, frame);
    ASSERT_TRUE(reader->read(number, capture));
    ASSERT_TRUE(frame.head && capture.pan_tilt);
    EXPECT_NEAR(capture.pan_tilt->pan_rad, frame.head->pan_rad, 1e-9);
    EXPECT_NEAR(capture.pan_tilt->tilt_rad, frame.head->tilt_rad, 1e-9);
    EXPECT_EQ(capture.tick, 4U * static_cast<unsigned>(number));
    EXPECT_EQ(capture.mid_exposure.time_since_epoch().count(), (number - 1) * 40'000'000);
    EXPECT_EQ(capture.status_of(capture::Stream::kPanTilt), capture::StreamStatus::kFresh);
  }
  EXPECT_GT(frame.head->pan_rad, 10 * kStep_rad);
}

TEST_F(MovingRig, ASweepStandsStillAtEachViewAndItsPosesAreThoseOfTheChain) {
  studio::StudioOptions options = options_of(studio::Scenario::kSweep);
  options.sweep = {{{0.4, -0.2}, {-0.9, 1.2}}, 2, false};
  ASSERT_TRUE(write_studio_take(options, take(), take::StreamFormat::kPng, [](int) {}));
  const auto known = calibration_file::read_calibration(take() / "truth/calibration.toml");
  auto reader = take::TakeReader::open(take());
  ASSERT_TRUE(known && known->pan_tilt && reader);
  const Eigen::Isometry3d world_from_base = pose_of(truth().at("world_from_base"));
  capture::Capture capture;
  for (int number = 1; number <= 4; ++number) {
    ASSERT_TRUE(reader->read(number, capture));
    ASSERT_TRUE(capture.pan_tilt);
    const studio::HeadAngles& view = options.sweep.views[static_cast<std::size_t>(number - 1) / 2];
    EXPECT_NEAR(capture.pan_tilt->pan_rad, view.pan_rad, 0.51 * kStep_rad);
    EXPECT_NEAR(capture.pan_tilt->tilt_rad, view.tilt_rad, 0.51 * kStep_rad);
    const Eigen::Isometry3d chain =
        world_from_base * test::base_from_target(*known->pan_tilt, capture.pan_tilt->pan_rad,
                                                 capture.pan_tilt->tilt_rad);
    EXPECT_LT(test::angle_between(chain, test::isometry(capture.world_from_target)), 3e-4);
  }
}

TEST(StudioHead, TheCamerasSeeTheRoomFromWhereTheHeadStands) {
  auto source = open_studio_source("sweep,14,sr3000,,64x48");
  ASSERT_TRUE(source) << source.error().context;
  EXPECT_FALSE((*source)->info().has_truth);
  capture::RenderedHead* head = (*source)->rendered().head;
  ASSERT_NE(head, nullptr);
  EXPECT_NEAR(head->limits().maximum.tilt_rad, M_PI / 2, 1e-12);
  const auto studio = studio::Studio::create(options_of(studio::Scenario::kPan));
  const studio::PanTiltUnit unit = *studio->info().pan_tilt;
  capture::Capture rest, capture;
  ASSERT_TRUE((*source)->read(1, rest));
  head->turn({{0.4, -0.2}, {}, 0});
  ASSERT_TRUE((*source)->read(2, capture));
  ASSERT_TRUE(capture.pan_tilt);
  EXPECT_NEAR(capture.pan_tilt->pan_rad, 0.4, 0.51 * kStep_rad);
  EXPECT_NEAR(capture.pan_tilt->tilt_rad, -0.2, 0.51 * kStep_rad);
  const auto turned = geometry::inverse(rest.world_from_target) * capture.world_from_target;
  const auto expected = studio::rest_from_turned(unit, 0.4, -0.2);
  EXPECT_LT(test::angle_between(test::isometry(turned), test::isometry(expected)), 5e-4);
  EXPECT_FALSE(std::equal(rest.plate.row(24), rest.plate.row(24) + 64, capture.plate.row(24)));
}

TEST(StudioHead, ASwingIsInThePicturesAndNotInTheAngles) {
  auto source = open_studio_source("sweep,14,sr3000,,64x48");
  ASSERT_TRUE(source);
  capture::Capture still, swung;
  (*source)->rendered().head->turn({{0.4, 0}, {}, 0});
  ASSERT_TRUE((*source)->read(5, still));
  (*source)->rendered().head->turn({{0.4, 0}, {}, 0.01});
  ASSERT_TRUE((*source)->read(5, swung));
  EXPECT_EQ(still.pan_tilt->pan_rad, swung.pan_tilt->pan_rad);
  EXPECT_NEAR(test::angle_between(test::isometry(still.world_from_target),
                                  test::isometry(swung.world_from_target)),
              0.01, 2e-5);  // the axis has a scale
}

TEST(StudioHead, TurnsOnUntilTheLaterExposureOfTheDepthCamera) {
  studio::StudioOptions options = options_of(studio::Scenario::kSweep);
  options.realism.late_depth = true;
  auto studio = studio::Studio::create(options);
  ASSERT_TRUE(studio);
  studio::Frame still, turning;
  studio->turn_head({{0.4, 0}, {}, 0});
  studio->render(5, still);
  studio->turn_head({{0.4, 0}, {2, 0}, 0});
  studio->render(5, turning);
  EXPECT_TRUE(std::equal(still.color.row(24), still.color.row(24) + 64, turning.color.row(24)));
  EXPECT_FALSE(std::equal(still.tof_distance_m.row(70), still.tof_distance_m.row(70) + 176,
                          turning.tof_distance_m.row(70)));
}

TEST(StudioHead, OtherScenariosHaveNone) {
  auto source = open_studio_source("pan,14,sr3000,4,64x48");
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)->rendered().head, nullptr);
}

TEST_F(MovingRig, TheSourceGivesWhatTheTakeHolds) {
  make(studio::Scenario::kPan);
  auto source = open_studio_source("pan,14,sr3000,4,64x48");
  auto reader = take::TakeReader::open(take());
  ASSERT_TRUE(source && reader);
  capture::Capture live, recorded;
  ASSERT_TRUE((*source)->read(3, live));
  ASSERT_TRUE(reader->read(3, recorded));
  ASSERT_TRUE(live.pan_tilt && recorded.pan_tilt);
  EXPECT_NEAR(live.pan_tilt->pan_rad, recorded.pan_tilt->pan_rad, 1e-9);
  EXPECT_EQ(live.tick, recorded.tick);
  EXPECT_EQ(live.mid_exposure, recorded.mid_exposure);
}

TEST_F(MovingRig, TheTrueCalibrationTurnsTheAnglesIntoThePosesOfTheTake) {
  make(studio::Scenario::kPan);
  const auto known = calibration_file::read_calibration(take() / "truth/calibration.toml");
  ASSERT_TRUE(known) << known.error().context;
  ASSERT_TRUE(known->pan_tilt);
  auto reader = take::TakeReader::open(take());
  const Eigen::Isometry3d world_from_base = pose_of(truth().at("world_from_base"));
  capture::Capture capture;
  for (int number = 1; number <= 4; ++number) {
    ASSERT_TRUE(reader->read(number, capture));
    const Eigen::Isometry3d chain =
        world_from_base * test::base_from_target(*known->pan_tilt, capture.pan_tilt->pan_rad,
                                                 capture.pan_tilt->tilt_rad);
    const Eigen::Isometry3d pose = test::isometry(capture.world_from_target);
    // Half a step of each axis, and the play of the axes.
    EXPECT_LT(test::angle_between(chain, pose), 0.71 * kStep_rad + 3e-4);
    EXPECT_LT((chain.translation() - pose.translation()).norm(), 1e-4);
  }
  const Eigen::Isometry3d at_rest =
      world_from_base * test::base_from_target(*known->pan_tilt, 0, 0);
  EXPECT_TRUE(at_rest.isApprox(pose_of(truth().at("world_from_rest")), 1e-9));
  EXPECT_EQ(std::get<geometry::CameraModel>(known->camera("tof")->model).pinhole.fx_px,
            reader->info().tof.pinhole.fx_px);
}

TEST_F(MovingRig, HandheldHasAMotionCaptureStreamThatItsTruthExplains) {
  make(studio::Scenario::kHandheld);
  EXPECT_FALSE(fs::exists(take() / "pan_tilt.csv"));
  const auto stream = trajectory::read_trajectory(take() / "mocap.txt");
  ASSERT_TRUE(stream) << stream.error().context;
  const nlohmann::json mocap = truth().at("mocap");
  const auto known = calibration_file::read_calibration(take() / "truth/calibration.toml");
  ASSERT_TRUE(known && known->pose("body") != nullptr);
  const Eigen::Isometry3d body_from_target =
      test::isometry(known->pose("body")->target_from).inverse();
  EXPECT_TRUE(body_from_target.isApprox(pose_of(mocap.at("body_from_target")), 1e-9));
  auto reader = take::TakeReader::open(take());
  capture::Capture capture;
  for (int number = 1; number <= 4; ++number) {
    ASSERT_TRUE(reader->read(number, capture));
    const double stamp_s = mocap.at("clock_offset_s").get<double>() +
                           (1 + mocap.at("clock_drift").get<double>()) *
                               (capture.time_s + mocap.at("delay_s").get<double>());
    const auto body = stream->at(stamp_s);
    ASSERT_TRUE(body) << "frame " << number;
    const Eigen::Isometry3d seen = test::isometry(*body) * body_from_target;
    const Eigen::Isometry3d pose = test::isometry(capture.world_from_target);
    EXPECT_LT(test::angle_between(seen, pose), 4 * 0.02 * M_PI / 180);
    EXPECT_LT((seen.translation() - pose.translation()).norm(), 0.001);
  }
}

/// Number after `key = ` in a file; NaN where it is not there.
double number_of(const fs::path& path, const std::string& key) {
  const std::string text = test::read_bytes(path);
  const std::size_t at = text.find(key + " = ");
  return at == std::string::npos ? NAN : std::stod(text.substr(at + key.size() + 3));
}

TEST_F(MovingRig, ScenesNameThePosesThatTheTakeHas) {
  make(studio::Scenario::kPan);
  EXPECT_NE(test::read_bytes(take() / "scene.toml").find("pose = \"take\""), std::string::npos);
  const std::string head = test::read_bytes(take() / "scene_pan_tilt.toml");
  EXPECT_NE(head.find("pose = \"pan_tilt\""), std::string::npos);
  EXPECT_NE(head.find("calibration = \"truth/calibration.toml\""), std::string::npos);
  EXPECT_NE(head.find("world_from_base"), std::string::npos);
  const fs::path scene = take() / "scene_mocap.toml";
  EXPECT_NE(test::read_bytes(scene).find("pose = \"recorded\""), std::string::npos);
  const double offset_s = number_of(scene, "time_offset_s");
  const auto stream = trajectory::read_trajectory(take() / "mocap_target.txt");
  ASSERT_TRUE(stream) << stream.error().context;
  auto reader = take::TakeReader::open(take());
  capture::Capture capture;
  for (int number = 1; number <= 4; ++number) {
    ASSERT_TRUE(reader->read(number, capture));
    // A millisecond at 30 deg/s is 0.03 deg.
    const auto pose = stream->at(capture.time_s - offset_s);
    ASSERT_TRUE(pose);
    EXPECT_LT(pose->rotation.angularDistance(capture.world_from_target.rotation),
              4 * 0.02 * M_PI / 180);
    EXPECT_LT((pose->translation_m - capture.world_from_target.translation_m).norm(), 0.001);
  }
}

TEST_F(MovingRig, AStillTakeHasNoneOfTheseFiles) {
  make(studio::Scenario::kStill);
  for (const char* file :
       {"pan_tilt.csv", "ticks.csv", "mocap.txt", "constellation.toml", "scene_pan_tilt.toml",
        "scene_mocap.toml", "truth/rig.json", "truth/calibration.toml"})
    EXPECT_FALSE(fs::exists(take() / file)) << file;
}

}  // namespace
}  // namespace mixrig::studio_io
