// SPDX-License-Identifier: Apache-2.0
// A recorded sweep of the box room, whose pictures are computed by formula: the scanned room must
// have the box's lengths. The sweep of the virtual board (tests/board/rig_scan_test.cpp) is checked
// by the same code.
#include <array>

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/take/growing_take.h"
#include "host/room/sweep/room_scan.h"
#include "tests/support/box_head.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

const test::BoxHead kBoxHead;

capture::Capture box_capture(double pan_rad, double tilt_rad) {
  capture::Capture frame;
  frame.depth_m.reset({test::kBoxTofWidth, test::kBoxTofHeight});
  frame.plate.reset({test::kBoxColorWidth, test::kBoxColorHeight});
  frame.pan_tilt = device::PanTiltAngles{pan_rad, tilt_rad};
  frame.set_status(capture::Stream::kPlate, capture::StreamStatus::kFresh);
  frame.set_status(capture::Stream::kDepth, capture::StreamStatus::kFresh);
  const auto mm = kBoxHead.distances_mm(pan_rad, tilt_rad);
  const auto yuyv = kBoxHead.yuyv(pan_rad, tilt_rad);
  std::size_t i = 0;
  for (int y = 0; y < frame.depth_m.height(); ++y)
    for (int x = 0; x < frame.depth_m.width(); ++x)
      frame.depth_m.at(x, y) = 0.001F * static_cast<float>(mm[i++]);
  i = 0;
  for (int y = 0; y < frame.plate.height(); ++y)
    for (int x = 0; x < frame.plate.width(); ++x, i += 2)
      frame.plate.at(x, y) = {yuyv[i], yuyv[i], yuyv[i]};
  return frame;
}

TEST(BoxRoom, IsWhatRaysByHandMeet) {
  using Eigen::Vector3d;
  const Vector3d eye(0.1, 0.2, 0.3);
  const auto ahead = test::BoxRoom::hit(eye, {0, 2, 0});
  EXPECT_EQ(ahead.wall, 4U);
  EXPECT_DOUBLE_EQ(ahead.length, 1.2);  // 2.6 - 0.2, in lengths of the ray
  EXPECT_EQ(test::BoxRoom::hit(eye, {-3, 1, 0}).wall, 0U);
  EXPECT_DOUBLE_EQ(test::BoxRoom::hit(eye, {0.1, 0, -1}).length, 1.3);
  // The head looks ahead, to the left and up. The ToF camera stands 4 cm before and 6 cm above the
  // origin; the tilt axis is 2 cm before it.
  const auto middle_mm = [](double pan_rad, double tilt_rad) {
    return kBoxHead.distances_mm(pan_rad - 0.012, tilt_rad)[60 * test::kBoxTofWidth + 80];
  };
  EXPECT_NEAR(middle_mm(0, 0), 2600 - 40, 4);
  EXPECT_NEAR(middle_mm(std::numbers::pi / 2, 0), 1700 - 40, 4);
  EXPECT_NEAR(middle_mm(0, std::numbers::pi / 2), 1150 - 20, 4);
}

TEST(BoxRoom, IsScannedWithItsLengths) {
  const test::TemporaryFolder folder;
  const auto calibration = folder / "calibration.toml";
  ASSERT_TRUE(calibration_file::write_calibration(calibration, test::box_calibration()));
  take::TakeInfo info;
  info.name = "box";
  info.target.pinhole = {{test::kBoxColorWidth, test::kBoxColorHeight}, 105, 105, 79.5, 44.5};
  info.tof.pinhole = {{test::kBoxTofWidth, test::kBoxTofHeight}, 144, 144, 79.5, 59.5};
  info.depth_kind = capture::DepthKind::kDistance;
  info.depth_unit_m = 0.001;
  info.calibration = calibration;
  auto take = take::GrowingTake::open(folder / "sweep", info);
  ASSERT_TRUE(take) << take.error().context;
  for (const double tilt_rad : {-0.18, 0.18})
    for (const double pan_rad : {-0.45, 0.0, 0.45}) {
      const std::array frames{box_capture(pan_rad, tilt_rad), box_capture(pan_rad, tilt_rad)};
      const auto appended = take->append(frames, {pan_rad, tilt_rad});
      ASSERT_TRUE(appended) << appended.error().context;
    }
  RoomScanOptions options;
  options.take = folder / "sweep", options.calibration = calibration;
  options.panorama.height_px = 360;
  const auto room = scan_room(options);
  ASSERT_TRUE(room) << room.error().context;
  const Image<float>& distance_m = room->panorama.distance_m;
  const auto errors =
      test::box_errors(720, 360, 90, 50, [&](int x, int y) { return distance_m.at(x, y); });
  EXPECT_EQ(errors.known_pct, 100);
  EXPECT_LT(errors.surface(0.95), 1);
  for (const auto& [wall, other] : test::kBoxLengths) {
    const auto length = test::length_errors(errors, wall, other);
    EXPECT_LT(length.mean_mm, 1) << wall;
    EXPECT_LT(length.largest_mm, 2) << wall;
  }
}

}  // namespace
}  // namespace mixrig::session
