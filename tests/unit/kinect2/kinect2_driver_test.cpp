// SPDX-License-Identifier: Apache-2.0
// Kinects by the list of their serial numbers, and by URI.
#include "extras/kinect2/kinect2_driver.h"

#include <array>

#include <gtest/gtest.h>

#include "host/capture/live/rig/devices.h"
#include "host/capture/live/rig/discover.h"

namespace mixrig::device {
namespace {

TEST(Kinect2Found, KinectsAreFoundByTheirSerialNumbers) {
  const auto kinects = kinects_of({"000123", "000456"});
  std::vector<std::string> left_out;
  const live::RigConfig found = live::rig_of(kinects, left_out);
  const auto rig = live::parse_rig(live::rig_text(found), "found.toml");
  ASSERT_TRUE(rig) << to_line(rig.error());
  ASSERT_EQ(rig->cameras.size(), 2U);
  EXPECT_EQ(rig->cameras[0].uri, "kinect2:000123/color");
  EXPECT_EQ(rig->cameras[1].uri, "kinect2:000456/color");
  ASSERT_TRUE(rig->depth && rig->depth2);
  EXPECT_EQ(rig->depth->uri, "kinect2:000123");
  EXPECT_EQ(rig->depth2->uri, "kinect2:000456");
  EXPECT_TRUE(rig->depth->request.size.empty()) << "the driver has one mode";
  EXPECT_EQ(left_out, std::vector<std::string>{});
}

TEST(Kinect2Found, AKinectWithoutASerialNumberIsTheOnlyOneOrLeftOut) {
  EXPECT_EQ(kinects_of({""}).at(1).uri, "kinect2:");
  const auto kinects = kinects_of({"", "000456"});
  ASSERT_EQ(kinects.size(), 2U);
  EXPECT_EQ(kinects[1].uri, "kinect2:000456");
}

TEST(Kinect2Driver, AnUnknownSerialNumberIsToldWithWhatIsThere) {
  SystemClock clock;
  const std::array kinds{kinect2_kind()};
  live::DeviceOpener opener(clock, {}, kinds);
  const auto depth = opener.depth("kinect2:no-such-serial", {});
  ASSERT_FALSE(depth);
  EXPECT_NE(to_line(depth.error()).find("kinect2:no-such-serial"), std::string::npos);
  EXPECT_FALSE(opener.camera("kinect2:no-such-serial/color", {}));
  const auto depth_as_camera = opener.camera("kinect2:no-such-serial", {});
  ASSERT_FALSE(depth_as_camera);
  EXPECT_EQ(depth_as_camera.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace mixrig::device
