// SPDX-License-Identifier: Apache-2.0
// Real pairs of rigidly mounted sensors: trajectories-rigid-pairs.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "host/pose/trajectory/align.h"

namespace mixrig::trajectory {
namespace {

using estimation::Standing;
constexpr double kDegree = M_PI / 180;

class AlignData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("MIXRIG_DATA");
    folder_ = std::filesystem::path(root ? root : "") / "trajectories-rigid-pairs";
    if (root == nullptr || !std::filesystem::exists(folder_))
      GTEST_SKIP() << "needs trajectories-rigid-pairs: set MIXRIG_DATA to the folder that holds it";
  }
  estimation::Estimate<Alignment> align_files(const std::string& a, const std::string& b) {
    const auto ta = read_trajectory(folder_ / a), tb = read_trajectory(folder_ / b);
    if (!ta || !tb) return estimation::Estimate<Alignment>::degenerate("a file cannot be read");
    const auto fit = align(*ta, *tb);
    std::printf("%-28s <- %-28s %-10s offset %+.5f s (sigma %.5f), residual %.3f deg\n", a.c_str(),
                b.c_str(), estimation::name_of(fit.verdict.standing), fit.value.time_offset_s,
                fit.value.time_offset_sigma_s, fit.value.median_residual_rad / kDegree);
    return fit;
  }
  std::filesystem::path folder_;
};

TEST_F(AlignData, TangoOffsetsAndRotationsClose) {
  const auto nm = align_files("tango_easy/nero.csv", "tango_easy/mars.csv");
  const auto mc = align_files("tango_easy/mars.csv", "tango_easy/caligula.csv");
  const auto nc = align_files("tango_easy/nero.csv", "tango_easy/caligula.csv");
  ASSERT_TRUE(nm.usable() && mc.usable() && nc.usable());
  EXPECT_NEAR(nm.value.time_offset_s, 107.736, 0.002);
  EXPECT_NEAR(mc.value.time_offset_s, 126.836, 0.002);
  EXPECT_NEAR(nc.value.time_offset_s, 234.570, 0.002);
  EXPECT_NEAR(nm.value.time_offset_s + mc.value.time_offset_s, nc.value.time_offset_s, 0.002);
  const auto round = nm.value.a_from_b * mc.value.a_from_b;
  EXPECT_LT(round.angularDistance(nc.value.a_from_b), 0.2 * kDegree);
  EXPECT_LE(nm.value.median_residual_rad, 0.14 * kDegree);
  EXPECT_LE(mc.value.median_residual_rad, 0.11 * kDegree);
  EXPECT_LE(nc.value.median_residual_rad, 0.11 * kDegree);
}

TEST_F(AlignData, PrimesenseCameraLagsItsMocap) {
  const auto fit = align_files("primesense_1/mocap.csv", "primesense_1/camera.csv");
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_NEAR(fit.value.time_offset_s, 0.020, 0.010);
  const Eigen::Quaterniond reference(0.604, -0.427, 0.364, -0.567);
  EXPECT_LT(fit.value.a_from_b.angularDistance(reference.normalized()), 2 * kDegree);
}

TEST_F(AlignData, FalconPairsAgree) {
  const auto infrared = align_files("falcon_5/mocap.csv", "falcon_5/infrared.csv");
  ASSERT_TRUE(infrared.usable()) << infrared.verdict.reason;
  EXPECT_NEAR(infrared.value.time_offset_s, 0.408, 0.010);
  const auto odometry = align_files("falcon_5/imu_odom.csv", "falcon_5/infrared.csv");
  ASSERT_TRUE(odometry.usable()) << odometry.verdict.reason;
  EXPECT_NEAR(odometry.value.time_offset_s, -0.012, 0.010);
  EXPECT_LT(odometry.value.a_from_b.angularDistance(Eigen::Quaterniond::Identity()), 1.2 * kDegree);
}

TEST_F(AlignData, WeakOrUnrelatedPairsAreSaidToBe) {
  EXPECT_EQ(align_files("falcon_5/mocap.csv", "falcon_5/color.csv").verdict.standing,
            Standing::kWeak);
  EXPECT_FALSE(align_files("falcon_5/mocap.csv", "falcon_5/fisheye.csv").usable());
  EXPECT_FALSE(align_files("primesense_1/mocap.csv", "tango_easy/nero.csv").usable());
}

TEST_F(AlignData, TumGroundTruthAndSlamShareAClock) {
  const auto fit = align_files("tum_fr1_xyz/freiburg1_xyz-groundtruth.txt",
                               "tum_fr1_xyz/freiburg1_xyz-rgbdslam.txt");
  ASSERT_TRUE(fit.usable()) << fit.verdict.reason;
  EXPECT_NEAR(fit.value.time_offset_s, 0.0, 0.02);
}

}  // namespace
}  // namespace mixrig::trajectory
