// SPDX-License-Identifier: Apache-2.0
// Plans and refusals of a live scan before the head turns: the studio's cameras and an emulated
// unit behind a pseudo-terminal.
#include "host/room/sweep/live_scan.h"

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "studio/io/studio_source.h"
#include "tests/support/ptu_on_a_pty.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

geometry::CameraModel pinhole(Size size, double focal_px) {
  geometry::CameraModel model;
  model.pinhole = {size, focal_px, focal_px, 0.5 * (size.width - 1), 0.5 * (size.height - 1)};
  return model;
}

class LiveScanPlan : public ::testing::Test {
 protected:
  void SetUp() override {
    if (unit_.name().empty()) GTEST_SKIP() << "no pseudo-terminal is available here";
    const std::string studio = "uri = \"studio:sweep,5,sr3000,,64x48/";
    options_.rig = folder_.write(
        "rig.toml", "format = 1\nname = \"made\"\n[[camera]]\nname = \"color\"\n" + studio +
                        "target\"\n[depth]\n" + studio +
                        "tof\"\n[pan_tilt]\nuri = \"flir-ptu:" + unit_.name() + "\"\n");
    options_.out = folder_ / "room";
    options_.kinds.sources = {{"studio", "studio:OPTIONS", studio_io::open_studio_source}};
    options_.calibration = folder_ / "calibration.toml";
    options_.planned = [this](const LiveScan& plan) { plan_ = plan; };
    write({64, 48});
  }
  void write(Size target) {
    calibration_file::Calibration known;
    known.cameras = {{"target", pinhole(target, 60), {}, 0, 0, 0, {}},
                     {"tof", pinhole({176, 144}, 200), {}, 0, 0, 0, {}}};
    known.poses.push_back({"tof", {}, {}, 0, 0, {}});
    known.pan_tilt.emplace();
    ASSERT_TRUE(calibration_file::write_calibration(options_.calibration, known));
  }
  /// Nothing is taken: it is stopped from the beginning.
  Result<LiveScan> scanned() {
    const std::atomic<bool> stop = true;
    return sweep_room(options_, stop, clock_);
  }
  std::string refused(ErrorCode code) {
    const auto scan = scanned();
    EXPECT_FALSE(scan);
    if (scan) return {};
    EXPECT_EQ(scan.error().code, code) << scan.error().context;
    return scan.error().context;
  }

  test::PtuOnAPty unit_;
  const test::TemporaryFolder folder_;
  SystemClock clock_;
  LiveScanOptions options_;
  LiveScan plan_;
};

TEST_F(LiveScanPlan, SaysWhatTheLimitsOfTheUnitLeaveOut) {
  const auto scan = scanned();
  ASSERT_TRUE(scan) << scan.error().context;
  EXPECT_TRUE(scan->stopped);
  EXPECT_EQ(scan->views, 0);
  // The plan covers 31 degrees up to 47 down, plus half the height of a view in its middle at each
  // end: (sin 51 + sin 67) / 2 of the band.
  EXPECT_GT(plan_.covered_share, 0.80);
  EXPECT_LT(plan_.covered_share, 0.85);
  options_.out = folder_ / "small";
  options_.field_deg = {80, 60};
  ASSERT_TRUE(scanned());
  EXPECT_EQ(plan_.covered_share, 1);
  EXPECT_EQ(plan_.planned, 6);
}

TEST_F(LiveScanPlan, ACalibrationOfAnotherPictureSizeIsRefused) {
  write({320, 256});
  const std::string why = refused(ErrorCode::kFormat);
  EXPECT_NE(why.find("320x256"), std::string::npos) << why;
  EXPECT_NE(why.find("64x48"), std::string::npos) << why;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "room.sweep"));
}

TEST_F(LiveScanPlan, AnotherFieldOrAFolderOfSomebodyElseIsRefused) {
  options_.field_deg = {80, 60};
  ASSERT_TRUE(scanned());
  options_.field_deg = {60, 60};
  EXPECT_NE(refused(ErrorCode::kUsage).find("another field_deg"), std::string::npos);
  options_.out = folder_ / "other";
  (void)folder_.write("other.sweep/mine.txt", "x");
  EXPECT_NE(refused(ErrorCode::kUsage).find("something else"), std::string::npos);
  options_.overlap = 2, options_.out = folder_ / "third";
  EXPECT_NE(refused(ErrorCode::kUsage).find("overlap"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "third.sweep"));
}

}  // namespace
}  // namespace mixrig::session
