// SPDX-License-Identifier: Apache-2.0
// Boards of a rig are calibrated by `mixrig calibrate rig` and `calibrate ptu`. The poses by this
// calibration for a panning take of the same rig are compared with the true poses, and in the
// picture of `mixrig run`, with the angles of mid-exposure, of the frame before, and of the frame's
// arrival.
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/take/take.h"
#include "tests/e2e/command.h"
#include "tests/support/axes_chain.h"

namespace mixrig::test {
namespace {

constexpr double kDeg = M_PI / 180;
constexpr int kSweepFrames = 126;     // two periods of the sweep
constexpr double kArrival_s = 0.030;  // delay of a frame's arrival after its mid-exposure
constexpr double kFast_rad_s = 25 * kDeg;
constexpr int kWidth_px = 64;         // width of the panning take
constexpr double kMostSlip_px = 0.7;  // at 1280 columns

struct Moment {
  double time_s = 0, speed_rad_s = 0;
  Eigen::Isometry3d world_from_target;
  device::PanTiltAngles head;
};

struct Rms {
  double angle_rad = 0, distance_m = 0;
  int frames = 0;
};

class PanTiltChain : public CommandTest {
 protected:
  std::vector<Moment> read_take(const std::string& name) const {
    auto reader = take::TakeReader::open(path(name));
    EXPECT_TRUE(reader) << reader.error().context;
    std::vector<Moment> moments;
    capture::Capture capture;
    for (int number = 1; reader && number <= reader->info().frames; ++number) {
      EXPECT_TRUE(reader->read(number, capture));
      EXPECT_TRUE(capture.pan_tilt);
      moments.push_back(
          {capture.time_s, 0, isometry(capture.world_from_target), *capture.pan_tilt});
    }
    for (std::size_t i = 1; i + 1 < moments.size(); ++i)
      moments[i].speed_rad_s =
          angle_between(moments[i - 1].world_from_target, moments[i + 1].world_from_target) /
          (moments[i + 1].time_s - moments[i - 1].time_s);
    return moments;
  }
  Eigen::Isometry3d truth(const std::string& name, const char* key) const {
    const auto pose = report(name + "/truth/rig.json").at(key);
    const auto q = pose.at("rotation_xyzw").get<std::vector<double>>();
    const auto t = pose.at("translation_m").get<std::vector<double>>();
    return isometry({Eigen::Quaterniond(q[3], q[0], q[1], q[2]), {t[0], t[1], t[2]}});
  }
  nlohmann::json pose_of_run(const std::vector<Moment>& take, double late_s) const;
  void judge_slip(const std::vector<Moment>& take, const calibration_file::PanTilt& estimated,
                  calibration_file::Calibration known) const;
};

/// Angles at `late_s` after frame i, interpolated between the rows of the frames.
device::PanTiltAngles angles_at(const std::vector<Moment>& take, std::size_t i, double late_s) {
  const Moment &a = take[late_s < 0 ? i - 1 : i], &b = take[late_s < 0 ? i : i + 1];
  const double part = (take[i].time_s + late_s - a.time_s) / (b.time_s - a.time_s);
  return {std::lerp(a.head.pan_rad, b.head.pan_rad, part),
          std::lerp(a.head.tilt_rad, b.head.tilt_rad, part)};
}

/// RMS error of the chain's poses over the frames in which the head turns at least at
/// `least_rad_s`.
Rms error_of(const std::vector<Moment>& take, const calibration_file::PanTilt& unit,
             const Eigen::Isometry3d& world_from_base, double late_s, double least_rad_s) {
  Rms rms;
  for (std::size_t i = 1; i + 1 < take.size(); ++i) {
    if (take[i].speed_rad_s < least_rad_s) continue;
    const auto [pan_rad, tilt_rad] = angles_at(take, i, late_s);
    const Eigen::Isometry3d pose = world_from_base * base_from_target(unit, pan_rad, tilt_rad);
    const Eigen::Isometry3d& known = take[i].world_from_target;
    rms.angle_rad += std::pow(angle_between(pose, known), 2);
    rms.distance_m += (pose.translation() - known.translation()).squaredNorm();
    ++rms.frames;
  }
  return {std::sqrt(rms.angle_rad / rms.frames), std::sqrt(rms.distance_m / rms.frames),
          rms.frames};
}

void print(const char* what, const Rms& rms) {
  std::printf("%-34s %.4f deg %7.3f mm, %d frames\n", what, rms.angle_rad / kDeg,
              1000 * rms.distance_m, rms.frames);
}

/// `pose` in the report of a run whose angles are `late_s` after each frame.
nlohmann::json PanTiltChain::pose_of_run(const std::vector<Moment>& take, double late_s) const {
  std::ofstream angles(path("pan/pan_tilt.csv"));
  angles << "frame,pan_rad,tilt_rad\n";
  for (std::size_t i = 0; i < take.size(); ++i) {
    const bool inner = i > 0 && i + 1 < take.size();
    const auto [pan_rad, tilt_rad] = inner ? angles_at(take, i, late_s) : take[i].head;
    angles << fmt::format("{},{:.9f},{:.9f}\n", i + 1, pan_rad, tilt_rad);
  }
  angles.close();
  EXPECT_EQ(mixrig(fmt::format("run {0}/scene_pan_tilt.toml --source take:{0} --calibration {1} "
                               "--backend cpu --format none --frames 26-125 --json {2}",
                               path("pan"), path("run.toml"), path("run.json"))),
            0);
  return report("run.json").at("pose");
}

/// Compares the slip in the picture with its prediction. `known` has the cameras of the small take,
/// whose lens is not under test.
void PanTiltChain::judge_slip(const std::vector<Moment>& take,
                              const calibration_file::PanTilt& estimated,
                              calibration_file::Calibration known) const {
  known.pan_tilt = estimated;
  ASSERT_TRUE(calibration_file::write_calibration(path("run.toml"), known));
  const double scale = 1280.0 / kWidth_px;
  const auto slip_px = [&](double late_s) {
    const nlohmann::json pose = pose_of_run(take, late_s);
    const double rms = scale * pose.at("slip_px").at("rms").get<double>();
    const double sigma = scale * pose.at("slip_sigma_px").get<double>();
    std::printf(
        "angles %3.0f ms late: slip %.3f px RMS at 1280 columns, %.3f px predicted, %.1f %% "
        "within\n",
        1000 * late_s, rms, sigma, pose.at("within_95_pct").get<double>());
    return std::pair(rms, sigma);
  };
  const auto [slip, predicted] = slip_px(0);
  EXPECT_LE(slip, kMostSlip_px);
  // A constant error of a take may be up to twice its sigma; it is the smaller part of the slip.
  EXPECT_NEAR(slip / predicted, 1, 0.25);
  // At 1667 px per radian and up to 30 deg/s.
  EXPECT_GT(slip_px(-0.04).first, 10);
  EXPECT_GT(slip_px(kArrival_s).first, 8);
}

TEST_F(PanTiltChain, AnEstimatedChainGivesThePoseAtMidExposureOfATurningHead) {
  const std::string rig = " --rig sr3000 --seed 33 --tolerance 1 ", out = path("c.toml");
  const std::string size = "--size 320x256";
  ASSERT_EQ(studio("views", "--plain --scenario board --views 12" + rig + size), 0);
  ASSERT_EQ(mixrig("calibrate rig " + path("views") + " --out " + out), 0);
  ASSERT_EQ(studio("turn", "--plain --scenario board --ptu --views 12" + rig + size), 0);
  ASSERT_EQ(mixrig("calibrate ptu " + path("turn") + " --calibration " + out + " --out " + out), 0);
  ASSERT_EQ(studio("pan", "--plain --scenario pan" + rig + "--size 64x48 --frames " +
                              std::to_string(kSweepFrames)),
            0);
  const auto estimated = calibration_file::read_calibration(out);
  const auto known = calibration_file::read_calibration(path("pan/truth/calibration.toml"));
  ASSERT_TRUE(estimated && estimated->pan_tilt && known && known->pan_tilt);
  const std::vector<Moment> take = read_take("pan");
  ASSERT_EQ(take.size(), static_cast<std::size_t>(kSweepFrames));
  // The world is fixed by the target camera's pose at angles zero, as on a set.
  const auto anchored = [&](const calibration_file::PanTilt& unit) {
    return truth("pan", "world_from_rest") * base_from_target(unit, 0, 0).inverse();
  };
  const auto judge = [&](const calibration_file::PanTilt& unit, double late_s, double least) {
    return error_of(take, unit, anchored(unit), late_s, least);
  };
  const Rms all = judge(*estimated->pan_tilt, 0, 0),
            fast = judge(*estimated->pan_tilt, 0, kFast_rad_s),
            by_index = judge(*estimated->pan_tilt, -0.04, kFast_rad_s),
            at_arrival = judge(*estimated->pan_tilt, kArrival_s, kFast_rad_s);
  print("true calibration, all frames", judge(*known->pan_tilt, 0, 0));
  print("estimated, all frames", all);
  print("estimated, over 25 deg/s", fast);
  print("its base taken as the true one",
        error_of(take, *estimated->pan_tilt, truth("pan", "world_from_base"), 0, kFast_rad_s));
  print("row of the frame before", by_index);
  print("at arrival, 30 ms late", at_arrival);

  ASSERT_GT(fast.frames, 40);
  EXPECT_LT(fast.angle_rad, 0.03 * kDeg);
  EXPECT_LT(fast.distance_m, 0.003);
  EXPECT_LT(all.angle_rad, 0.03 * kDeg);
  // The head turns at 28 deg/s, for 40 and for 30 ms.
  EXPECT_NEAR(by_index.angle_rad / kDeg, 28 * 0.040, 0.1);
  EXPECT_NEAR(at_arrival.angle_rad / kDeg, 28 * kArrival_s, 0.1);
  judge_slip(take, *estimated->pan_tilt, *known);
}

}  // namespace
}  // namespace mixrig::test
