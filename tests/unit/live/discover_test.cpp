// SPDX-License-Identifier: Apache-2.0
// The rig.toml that is written for emulated lists of devices.
#include "host/capture/live/rig/discover.h"

#include <gtest/gtest.h>

namespace mixrig::live {
namespace {

using device::PixelFormat;
using Uris = std::vector<std::string>;

FoundCamera found(const std::string& uri, PixelFormat format, Size size = {640, 480},
                  std::uint16_t usb_vendor = 0) {
  FoundCamera camera{uri, {}};
  camera.info.size = size, camera.info.format = format, camera.info.rate_hz = 30;
  camera.info.usb_vendor = usb_vendor;
  return camera;
}

/// Writes a rig as rig.toml and reads it back.
RigConfig written(const RigConfig& rig) {
  const auto read = parse_rig(rig_text(rig), "found.toml");
  EXPECT_TRUE(read) << to_line(read.error()) << rig_text(rig);
  return read ? *read : RigConfig();
}

TEST(Discover, ASecondDepthCameraIsASecondTableAndAThirdIsNamed) {
  Uris left_out;
  const RigConfig rig = written(
      rig_of({found("openni2:a", PixelFormat::kRgb8), found("openni2:a", PixelFormat::kDepth16),
              found("v4l2:/dev/video4", PixelFormat::kDepth16, {848, 480}, 0x8086),
              found("usb:1209:0001", PixelFormat::kDepth16)},
             left_out));
  ASSERT_TRUE(rig.depth && rig.depth2);
  EXPECT_EQ(rig.depth->uri, "openni2:a");
  EXPECT_EQ(rig.depth->name, "depth");
  EXPECT_EQ(rig.depth2->uri, "v4l2:/dev/video4");
  EXPECT_EQ(rig.depth2->name, "depth2");
  EXPECT_EQ(rig.depth2->request.size, (Size{848, 480}));
  EXPECT_EQ(rig.cameras.at(0).name, "color");
  EXPECT_EQ(left_out, Uris{"usb:1209:0001"});
}

TEST(Discover, TheRawSideOfAProcessedCameraIsLeftOut) {
  std::vector<FoundCamera> cameras{
      found("v4l2:/dev/video0", PixelFormat::kBayerRggb16),
      found("v4l2:/dev/video2", PixelFormat::kYuyv, {640, 480}, 0x046D),
      found("processed:/base/imx219@10", PixelFormat::kNv12, {1920, 1080})};
  cameras.back().processed = true;
  Uris left_out;
  const RigConfig rig = written(rig_of(cameras, left_out));
  ASSERT_EQ(rig.cameras.size(), 2U);
  EXPECT_EQ(rig.cameras[0].uri, "v4l2:/dev/video2");
  EXPECT_EQ(rig.cameras[1].uri, "processed:/base/imx219@10");
  EXPECT_EQ(rig.cameras[1].name, "camera2");
  EXPECT_EQ(left_out, Uris{"v4l2:/dev/video0"});
  left_out.clear();
  EXPECT_EQ(rig_of({cameras[0], cameras[1]}, left_out).cameras.size(), 2U);
  EXPECT_EQ(left_out, Uris{});
}

}  // namespace
}  // namespace mixrig::live
