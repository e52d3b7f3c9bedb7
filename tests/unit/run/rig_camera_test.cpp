// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/rig_camera.h"

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

TEST(RigCamera, IsTheOneOfTheFileWithItsPlace) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "calibration.toml";
  calibration_file::Calibration known;
  known.cameras.push_back({.name = "fisheye",
                           .model = geometry::FisheyeModel({{64, 48}, 20, 20, 31.5, 23.5, {}}),
                           .covariance = {},
                           .origin = {}});
  ASSERT_TRUE(calibration_file::write_calibration(path, known));
  EXPECT_TRUE(
      test::refused(rig_camera(path, "fisheye"), {"mixrig calibrate rig"}, ErrorCode::kData));

  known.poses.push_back({.name = "fisheye",
                         .target_from = {Eigen::Quaterniond::Identity(), {0.07, 0.08, 0.01}},
                         .covariance = {},
                         .origin = {}});
  ASSERT_TRUE(calibration_file::write_calibration(path, known));
  const auto fisheye = rig_camera(path, "fisheye");
  ASSERT_TRUE(fisheye);
  EXPECT_EQ(geometry::size_px(fisheye->model), (Size{64, 48}));
  EXPECT_EQ(fisheye->camera_from_target.translation_m, Eigen::Vector3d(-0.07, -0.08, -0.01));
  EXPECT_FALSE(rig_camera(path, "target"));
  EXPECT_FALSE(rig_camera(folder.path() / "missing.toml", "fisheye"));
}

}  // namespace
}  // namespace mixrig::session
