// SPDX-License-Identifier: Apache-2.0
// Each source of the pose is tested in the picture: a virtual object stands still in the world
// while the camera moves sideways.
#include "host/run/session/camera_pose.h"

#include <fstream>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/capture/calibration_file/calibration.h"
#include "host/run/explain/explain.h"
#include "host/run/loop/run.h"
#include "tests/gl/quad_mesh.h"
#include "tests/support/progress.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/mocap/natnet_server.h"
#include "tests/unit/run/posed_source.h"

namespace mixrig::session {
namespace {

using capture::Capture;
using capture::PoseLoss;
using scene::PoseSource;
using test::PosedSource;

constexpr double kSpeed_m_s = 0.2;
constexpr float kQuad_z_m = 1;

/// Contents of one frame of the run.
struct Shown {
  int virtual_px = 0;
  double centre_px = 0;  ///< column of the object's centre
  capture::CameraPose pose;
};

class Watcher final : public output::CompositeSink {
 public:
  explicit Watcher(std::map<int, Shown>& shown) : shown_(shown) {}
  std::string_view name() const override { return "watcher"; }
  render::OutputMask wanted(int) const override { return render::kColor | render::kLayer; }
  Result<void> write(const output::CompositePtr& composite) override {
    Shown& shown = shown_[composite->capture->number];
    shown.pose = composite->pose;
    const auto& layer = composite->images.layer;
    double sum = 0;
    for (int y = 0; y < layer.height(); ++y)
      for (int x = 0; x < layer.width(); ++x)
        if (layer.at(x, y) == static_cast<std::uint8_t>(render::Layer::kVirtual))
          ++shown.virtual_px, sum += x;
    if (shown.virtual_px > 0) shown.centre_px = sum / shown.virtual_px;
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  std::map<int, Shown>& shown_;
};

calibration_file::Calibration with_chain() {
  calibration_file::Calibration calibration;
  calibration.pan_tilt.emplace();
  // The camera's y axis, down, is against the pan axis; x stays.
  calibration.pan_tilt->head_from_target.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  calibration.pan_tilt->tilt.direction = Eigen::Vector3d::UnitX();
  return calibration;
}

std::vector<std::vector<std::byte>> frames_of_body() {
  std::vector<std::vector<std::byte>> packets;
  for (int i = 0; i < 200; ++i)
    packets.push_back(stream::frame_with_body(i, 0.7F, 2e-4 * i, false).packet(7));
  return packets;
}

/// calibration.toml whose body is such that the stream's body puts the camera at x = 0.1 m.
calibration_file::Calibration with_body() {
  // frame_with_body(): at (x, 0.5, 0.25), half a turn about z, in a world with y up.
  const geometry::Pose z_up{
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX())),
      {0, 0, 0}};
  const geometry::Pose world_from_body{Eigen::Quaterniond(0, 0, 0, 1), {0.7, 0.5, 0.25}};
  const geometry::Pose target_from_world{Eigen::Quaterniond::Identity(), {-0.1, 0, 0}};
  calibration_file::Calibration calibration;
  calibration.poses.push_back({"body", target_from_world * z_up * world_from_body, {}, 0, 0, {}});
  return calibration;
}

class CameraPoseTest : public ::testing::Test {
 protected:
  CameraPoseTest() { session_.scene.path = "scene.toml"; }

  void use(std::unique_ptr<PosedSource> source) {
    session_.source = std::move(source);
    session_.setup = *setup_of(session_.source->info(), std::nullopt);
    session_.backend = {render::Backend::kCpu, 1};
    render::VirtualObject object;
    object.meshes.push_back(quad_.view);
    session_.setup.objects.push_back(std::move(object));
  }
  /// 120 Hz on a clock of its own, which reads kClock_s at the take's 0.
  std::filesystem::path write_trajectory(double from_s, double to_s, double gap_from_s = 1e9,
                                         double gap_to_s = 1e9) {
    std::string text = "# t x y z qx qy qz qw\n";
    for (double t_s = from_s; t_s < to_s + 1e-9; t_s += 1.0 / 120)
      if (t_s < gap_from_s || t_s > gap_to_s)
        text += fmt::format("{:.6f} {:.6f} 0 0 0 0 0 1\n", t_s + kClock_s, kSpeed_m_s * t_s);
    return folder_.write("mocap.txt", text);
  }
  void use_trajectory(const std::filesystem::path& path) {
    session_.scene.pose_source = PoseSource::kRecorded;
    session_.scene.camera.trajectory = path;
    session_.scene.camera.time_offset_s = -kClock_s;
  }
  void use_calibration(const calibration_file::Calibration& calibration) {
    session_.calibration.file = folder_ / "calibration.toml";
    ASSERT_TRUE(calibration_file::write_calibration(session_.calibration.file, calibration));
  }
  void use_mocap(const stream::NatNetServer& server) {
    session_.scene.pose_source = PoseSource::kMocap;
    session_.scene.camera.mocap.server = "127.0.0.1:" + std::to_string(server.port());
    session_.scene.camera.max_age_s = 600;  // however slowly this test runs
    use_calibration(with_body());
  }
  Result<RunReport> run_it(std::optional<std::filesystem::path> out = std::nullopt,
                           std::optional<FrameRange> frames = std::nullopt) {
    RunOptions options;
    options.frames = frames;
    options.out = std::move(out);
    options.output.format = output::OutputFormat::kNone;
    RunParts parts;
    parts.sinks.push_back(std::make_unique<Watcher>(shown_));
    return run(session_, options, clock_, {}, std::move(parts));
  }
  /// Column at which the object stands in frame `number`.
  static double expected_px(double time_s) {
    return PosedSource::kCentre_px - PosedSource::kFocal_px * kSpeed_m_s * time_s / kQuad_z_m;
  }
  void expect_error(ErrorCode code, const std::string& says) {
    EXPECT_TRUE(test::refused(run_it(), {says, "scene.toml: camera."}, code));
  }

  static constexpr double kClock_s = 5000.25;
  const test::TemporaryFolder folder_;
  const test::Quad quad_{{-0.05F, -0.05F}, {0.05F, 0.05F}, kQuad_z_m};
  std::map<int, Shown> shown_;
  Session session_;
  SystemClock clock_;
};

TEST_F(CameraPoseTest, ARecordedTrajectoryHoldsTheObjectStill) {
  use(std::make_unique<PosedSource>(40, nullptr));
  use_trajectory(write_trajectory(-0.5, 2));
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  ASSERT_EQ(shown_.size(), 40U);
  for (const auto& [number, shown] : shown_) {
    EXPECT_GT(shown.virtual_px, 20) << number;
    EXPECT_NEAR(shown.centre_px, expected_px((number - 1) / 25.0), 0.51) << number;
  }
  EXPECT_EQ(report->pose.source, "recorded");
  EXPECT_EQ(report->pose.frames.frames[0], 40U);
  EXPECT_EQ(report->pose.frames.lost(), 0U);
  EXPECT_LE(report->pose.age_ms.quantile(0.95), 0.5e3 / 120 + 0.01);
}

TEST_F(CameraPoseTest, WithoutAPoseTheObjectFreezesAndTheFrameSaysSo) {
  use(std::make_unique<PosedSource>(40, nullptr));
  use_trajectory(write_trajectory(0.199, 1.2, 0.65, 0.85));
  const auto report = run_it(folder_ / "out");
  ASSERT_TRUE(report) << report.error().context;
  for (const auto& [number, shown] : shown_) {
    const double t_s = (number - 1) / 25.0;
    const PoseLoss loss = t_s < 0.199 || t_s > 1.199 ? PoseLoss::kOutside
                          : t_s > 0.65 && t_s < 0.85 ? PoseLoss::kGap
                                                     : PoseLoss::kNone;
    EXPECT_EQ(shown.pose.loss, loss) << t_s;
    if (t_s < 0.199) {
      EXPECT_EQ(shown.virtual_px, 0) << "nowhere to be before the first pose";
    } else {
      const double known_s = t_s > 1.199 ? 1.16 : loss == PoseLoss::kGap ? 0.64 : t_s;
      EXPECT_NEAR(shown.centre_px, expected_px(known_s), 0.51) << t_s;
    }
  }
  const pose::FramePoseCounts& counts = report->pose.frames;
  EXPECT_EQ(counts.frames[static_cast<std::size_t>(PoseLoss::kOutside)], 5U + 10U);
  EXPECT_EQ(counts.frames[static_cast<std::size_t>(PoseLoss::kGap)], 5U);
  const auto json = to_json(*report)["pose"];
  EXPECT_EQ(json["lost"], 20);
  EXPECT_EQ(json["lost_by"]["gap"], 5);
  EXPECT_EQ(json["when_lost"], "freeze");
  EXPECT_NE(to_table(*report).find("pose lost in 20 frames (gap 5, outside 15)"),
            std::string::npos);
  std::ifstream table(folder_ / "out" / "frames.csv");
  std::string header, first;
  std::getline(table, header);
  std::getline(table, first);
  EXPECT_TRUE(header.ends_with(",pose,pose_age_ms,slip_px,slip_sigma_px")) << header;
  EXPECT_TRUE(first.ends_with(",outside,0.000,,")) << first;
}

TEST_F(CameraPoseTest, WithoutAPoseObjectsAreHiddenWhereTheSceneSaysSoAndTheSetStays) {
  for (const bool in_set : {false, true}) {
    use(std::make_unique<PosedSource>(40, nullptr));
    use_trajectory(write_trajectory(0, 2, 0.65, 0.85));
    session_.scene.camera.when_lost = scene::WhenLost::kHide;
    session_.setup.objects.back().in_set = in_set;
    session_.poses.reset();
    ASSERT_TRUE(run_it());
    for (const auto& [number, shown] : shown_)
      EXPECT_EQ(shown.virtual_px > 0, in_set || shown.pose.ok()) << number;
    EXPECT_EQ(shown_.at(18).pose.loss, PoseLoss::kGap);
  }
}

TEST_F(CameraPoseTest, APoseOlderThanTheSceneAcceptsIsLost) {
  use(std::make_unique<PosedSource>(40, nullptr));
  use_trajectory(write_trajectory(0, 2));
  session_.scene.camera.max_age_s =
      0.0025;  // samples are 8.3 ms apart: some frames are farther off
  const auto report = run_it();
  ASSERT_TRUE(report);
  const auto old = report->pose.frames.frames[static_cast<std::size_t>(PoseLoss::kTooOld)];
  EXPECT_GT(old, 0U);
  EXPECT_EQ(old, report->pose.frames.lost());
  EXPECT_GT(report->pose.frames.frames[0], 0U);
}

TEST_F(CameraPoseTest, NaNPosesOfATakeAreRejectedAndJumpsCounted) {
  use(std::make_unique<PosedSource>(10, [](Capture& capture) {
    capture.pose_origin = capture::PoseOrigin::kRecorded;
    capture.world_from_target = {};
    capture.world_from_target.translation_m.x() = capture.number == 4   ? NAN
                                                  : capture.number >= 8 ? 0.9
                                                                        : 0;
  }));
  session_.scene.pose_source = PoseSource::kRecorded;
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(shown_.at(4).pose.loss, PoseLoss::kNotFinite);
  EXPECT_NEAR(shown_.at(4).centre_px, PosedSource::kCentre_px, 0.51) << "frozen";
  EXPECT_EQ(report->pose.frames.jumps, 1U);
  EXPECT_NE(to_table(*report).find("jumps: 1 between frames"), std::string::npos);
}

TEST_F(CameraPoseTest, PosesWithoutCommonTimeAreRefused) {
  use(std::make_unique<PosedSource>(10, nullptr));
  use_trajectory(write_trajectory(0, 1));
  session_.scene.camera.time_offset_s = 0;
  expect_error(ErrorCode::kData, "no time in common, correct time_offset_s");
}

TEST_F(CameraPoseTest, RecordedPosesThatTheTakeLacksAreRefused) {
  use(std::make_unique<PosedSource>(10, nullptr));
  session_.scene.pose_source = PoseSource::kRecorded;
  expect_error(ErrorCode::kFormat, "the take has no poses of its own");
}

/// A head that pans by 0.3 rad/s.
void pan(Capture& capture) {
  capture.pan_tilt = {0.3 * capture.time_s, 0};
  capture.set_status(capture::Stream::kPanTilt, capture::StreamStatus::kFresh);
}

TEST_F(CameraPoseTest, ThePanTiltChainHoldsTheObjectStill) {
  use(std::make_unique<PosedSource>(20, pan));
  session_.scene.pose_source = PoseSource::kPanTilt;
  use_calibration(with_chain());
  // The base is placed so that the camera has the world's axes at angles zero.
  session_.scene.camera.world_from_base.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  for (const auto& [number, shown] : shown_) {
    // The object moves with the pan's angle to the left: positive about the axis that points up.
    const double angle_rad = 0.3 * (number - 1) / 25.0;
    EXPECT_NEAR(shown.centre_px,
                PosedSource::kCentre_px + PosedSource::kFocal_px * std::tan(angle_rad), 0.6)
        << number;
  }
  EXPECT_EQ(report->pose.source, "pan_tilt");
}

TEST_F(CameraPoseTest, AChainThatIsNotCalibratedIsRefused) {
  use(std::make_unique<PosedSource>(5, pan));
  session_.scene.pose_source = PoseSource::kPanTilt;
  session_.calibration.where = "[target] of take.toml";
  expect_error(ErrorCode::kFormat, "[target] of take.toml has no [pan_tilt]: calibrate the chain");
}

TEST_F(CameraPoseTest, ATakeWithoutAnglesIsRefused) {
  use(std::make_unique<PosedSource>(5, nullptr));
  session_.scene.pose_source = PoseSource::kPanTilt;
  use_calibration(with_chain());
  expect_error(ErrorCode::kFormat, "the take has no angles of the head");
}

TEST_F(CameraPoseTest, AFrameWithoutAnglesIsLost) {
  use(std::make_unique<PosedSource>(5, [](Capture& capture) {
    pan(capture);
    if (capture.number == 3) capture.pan_tilt.reset();
  }));
  session_.scene.pose_source = PoseSource::kPanTilt;
  use_calibration(with_chain());
  ASSERT_TRUE(run_it());
  EXPECT_EQ(shown_.at(3).pose.loss, PoseLoss::kNoAngle);
  EXPECT_TRUE(shown_.at(4).pose.ok());
}

TEST_F(CameraPoseTest, TruePosesOfTheSourceAreHeldAgainstThoseOfTheScene) {
  auto source = std::make_unique<PosedSource>(10, [](Capture& capture) {
    capture.world_from_target.translation_m = {0, 0.003, 0};
    capture.world_from_target.rotation = Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitZ());
  });
  source->tell_true_poses();
  use(std::move(source));
  session_.scene.pose_source = PoseSource::kFixed;
  session_.scene.camera.world_from_target.translation_m = {0.004, 0.003, 0};
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  const auto error = to_json(*report)["pose"]["error"];
  EXPECT_EQ(error["frames"], 10);
  EXPECT_NEAR(error["shift_mm"]["rms"], 4.0, 1e-9);
  EXPECT_NEAR(error["turn_deg"]["max"], 0.573, 1e-9);  // 0.01 rad, three digits
  session_.scene.pose_source = PoseSource::kIdentity;  // another world
  session_.poses.reset();
  const auto other = run_it();
  ASSERT_TRUE(other) << other.error().context;
  EXPECT_FALSE(to_json(*other)["pose"].contains("error"));
}

TEST_F(CameraPoseTest, ATurningHeadUnderAFixedPoseIsRefused) {
  for (const PoseSource source : {PoseSource::kTake, PoseSource::kIdentity, PoseSource::kFixed}) {
    use(std::make_unique<PosedSource>(20, pan));
    session_.scene.pose_source = source;
    session_.poses.reset();
    expect_error(ErrorCode::kData, "calibrate its chain by mixrig calibrate ptu");
  }
  use_calibration(with_chain());
  expect_error(ErrorCode::kData, "use pose = \"pan_tilt\", its chain is calibrated");
}

TEST_F(CameraPoseTest, ATurningHeadStopsALiveRun) {
  const HostTime later = clock_.now() + std::chrono::hours(1);  // no capture is late
  const auto turn = [&](Capture& capture) {
    pan(capture);
    capture.mid_exposure = later;
  };
  use(std::make_unique<PosedSource>(20, turn, true));
  session_.scene.pose_source = PoseSource::kIdentity;
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_NE(report->ended.find("the head has turned by"), std::string::npos) << report->ended;
  // 0.012 rad a frame: the second one is the first that turned.
  EXPECT_EQ(report->frames.frame_ms.count(), 1U);
}

TEST_F(CameraPoseTest, AHeadThatRestsOrIsFollowedByPosesOfTheTakeIsFine) {
  use(std::make_unique<PosedSource>(20, [](Capture& capture) {
    pan(capture);
    *capture.pan_tilt = {0.001 * (capture.number % 2), -0.001 * (capture.number % 2)};
  }));
  session_.scene.pose_source = PoseSource::kIdentity;
  EXPECT_TRUE(run_it());
  use(std::make_unique<PosedSource>(20, [](Capture& capture) {
    pan(capture);
    capture.pose_origin = capture::PoseOrigin::kRecorded;
  }));
  session_.scene.pose_source = PoseSource::kTake;
  session_.poses.reset();
  EXPECT_TRUE(run_it());
}

TEST_F(CameraPoseTest, AMotionCaptureOverTheNetworkMovesTheObject) {
  stream::NatNetServer server(frames_of_body());
  use_mocap(server);
  use(std::make_unique<PosedSource>(
      10,
      [this](Capture& capture) {
        // The first frame is composited without a pose if it comes before the first packet.
        EXPECT_TRUE(test::comes_true([&] {
          capture.mid_exposure = clock_.now();
          return capture.number == 1 || session_.poses->pose_of(capture).ok();
        }));
      },
      true));
  const auto report = run_it();
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_EQ(report->pose.source, "mocap");
  EXPECT_GE(report->pose.frames.frames[0], 1U);
  for (const auto& [number, shown] : shown_) {
    if (shown.pose.ok()) {
      EXPECT_NEAR(shown.centre_px, PosedSource::kCentre_px - PosedSource::kFocal_px * 0.1, 0.51);
    }
  }
}

TEST_F(CameraPoseTest, UnderAMotionCaptureTheBackgroundIsLearnedAtItsPoses) {
  stream::NatNetServer server(frames_of_body());
  use_mocap(server);
  use(std::make_unique<PosedSource>(
      1'000'000,  // more than this run can read
      [this](Capture& capture) {
        EXPECT_TRUE(test::comes_true([&] {
          capture.mid_exposure = clock_.now();
          return !session_.poses || session_.poses->pose_of(capture).ok();
        }));
      },
      true));
  session_.scene.background.learn = {1, 4};
  const auto report = run_it(std::nullopt, FrameRange{5, 8});
  ASSERT_TRUE(report) << report.error().context;
  EXPECT_TRUE(session_.setup.background.depth_m.empty()) << "a frozen background";
  ASSERT_FALSE(session_.setup.background_models.empty());
  EXPECT_NEAR(session_.setup.background_models.front().world_from_face[0].translation_m.x(), 0.1,
              1e-3);
}

TEST_F(CameraPoseTest, ABackgroundOfAMovingCameraNeedsALearnedFrameWithAPose) {
  // Frame 4 is at 0.12 s.
  const auto learn = [this](double poses_from_s) {
    use(std::make_unique<PosedSource>(20, nullptr));
    use_trajectory(write_trajectory(poses_from_s, 2));
    session_.scene.background.learn = {1, 4};
    session_.poses.reset();
    return run_it();
  };
  const auto without = learn(0.13);
  EXPECT_TRUE(test::refused(without, {}, ErrorCode::kData));
  EXPECT_TRUE(without.error().context.starts_with("scene.toml: background.learn: the camera moves"))
      << without.error().context;
  for (const char* part : {"at any of the frames 1-4", "learn from frames with poses"})
    EXPECT_NE(without.error().context.find(part), std::string::npos) << without.error().context;
  EXPECT_EQ(without.error().context.find('\n'), std::string::npos);

  const auto with = learn(0.1);
  ASSERT_TRUE(with) << with.error().context;
  ASSERT_FALSE(session_.setup.background_models.empty());
  EXPECT_NEAR(session_.setup.background_models.front().world_from_face[0].translation_m.x(),
              0.12 * kSpeed_m_s, 1e-3);
}

TEST_F(CameraPoseTest, AMotionCaptureNeedsLiveDevicesAndTheBodysPose) {
  session_.scene.pose_source = PoseSource::kMocap;
  session_.scene.camera.mocap.server = "127.0.0.1";
  use(std::make_unique<PosedSource>(5, nullptr));
  expect_error(ErrorCode::kUsage, "cannot belong to a recording");
  use(std::make_unique<PosedSource>(5, nullptr, true));
  session_.calibration.where = "what the devices report";
  expect_error(ErrorCode::kFormat,
               "what the devices report has no pose of the tracked body: make it by mixrig "
               "calibrate external");
}

TEST_F(CameraPoseTest, ExplainNamesTheSourceAndWhatALostPoseDoes) {
  use(std::make_unique<PosedSource>(10, nullptr));
  use_trajectory(write_trajectory(0, 1));
  session_.scene.camera.when_lost = scene::WhenLost::kHide;
  const auto explained = explain(session_, 4, {}, clock_, {});
  ASSERT_TRUE(explained) << explained.error().context;
  for (const char* part :
       {"recorded: ", "121 poses at 120.0 Hz", "older than 100 ms", "virtual objects are hidden"})
    EXPECT_NE(explained->camera.find(part), std::string::npos) << explained->camera;
  EXPECT_TRUE(explained->moving_p50_ms) << "the camera can move";
}

}  // namespace
}  // namespace mixrig::session
