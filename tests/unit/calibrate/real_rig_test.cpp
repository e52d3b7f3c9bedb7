// SPDX-License-Identifier: Apache-2.0
// `mixrig calibrate rig` on somebody's views by a Kinect v2, with a board that is small in them.
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/capture/calibration_file/calibration.h"
#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

TEST(RealRig, ViewsThatLeaveTheSidesOpenAreNoGoAndSayWhatToTake) {
  const char* data = std::getenv("MIXRIG_DATA");
  const std::string set = std::string(data == nullptr ? "" : data) + "/kinect2-rig";
  if (!std::filesystem::exists(set)) GTEST_SKIP() << "no recording kinect2-rig: set MIXRIG_DATA";
  const TinyTake take;
  const std::string command = "calibrate rig --corners-only " + set + " --out c.toml";
  const Outcome refused = take.mixrig(command);
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("c.toml is not written, no-go: target: a pixel is uncertain by"),
            std::string::npos)
      << refused.err;
  EXPECT_NE(refused.out.find("next view, tof: hold the board in the bottom left"),
            std::string::npos)
      << refused.out;
  EXPECT_FALSE(std::filesystem::exists(take.path("c.toml")));

  const Outcome forced = take.mixrig(command + " --force --json r.json");
  ASSERT_EQ(forced.status, 0) << forced.err;
  const auto written = calibration_file::read_calibration(take.path("c.toml"));
  ASSERT_TRUE(written) << written.error().context;
  ASSERT_EQ(written->poses.size(), 1U);
  // All 102 views of the recording give -51.9, -0.2, 0.2 mm, 0.16 mm of sigma along the base line.
  const Eigen::Vector3d mm = 1e3 * written->poses[0].target_from.translation_m;
  EXPECT_NEAR(mm.x(), -51.9, 0.16);
  EXPECT_LT(std::hypot(mm.y() + 0.2, mm.z() - 0.2), 0.5) << mm.transpose();
  std::printf("kinect2-rig: tof at %.2f %.2f %.2f mm\n", mm.x(), mm.y(), mm.z());
}

}  // namespace
}  // namespace mixrig::test
