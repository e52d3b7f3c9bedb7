// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/calibrated_source.h"

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "tests/support/box_source.h"
#include "tests/support/refusal.h"

namespace mixrig::capture {
namespace {
namespace fs = std::filesystem;

class CalibratedSourceTest : public ::testing::Test {
 protected:
  CalibratedSourceTest() {
    std::string pattern = (fs::temp_directory_path() / "mixrig-cal-XXXXXX").string();
    root_ = mkdtemp(pattern.data());
    const geometry::CameraModel target{{{64, 48}, 61, 62, 30, 20}, {}};
    const geometry::CameraModel tof{{{64, 48}, 51, 52, 33, 22}, {}};
    known_.cameras = {{"target", target, {}, 0, 0, 0, {}}, {"tof", tof, {}, 0, 0, 0, {}}};
    known_.poses = {{"tof", {Eigen::Quaterniond::Identity(), {-0.05, 0, 0.01}}, {}, 0, 0, {}}};
  }
  ~CalibratedSourceTest() override { fs::remove_all(root_); }

  Result<std::unique_ptr<CaptureSource>> open() {
    EXPECT_TRUE(calibration_file::write_calibration(file(), known_));
    return with_calibration(std::make_unique<test::BoxSource>(5, 6), file());
  }
  std::string error() {
    const auto source = open();
    if (source) return "";
    EXPECT_EQ(source.error().code, ErrorCode::kFormat);
    EXPECT_EQ(source.error().context.find('\n'), std::string::npos);
    EXPECT_TRUE(source.error().context.starts_with(file().string() + ": "));
    return source.error().context;
  }
  fs::path file() const { return root_ / "calibration.toml"; }

  fs::path root_;
  calibration_file::Calibration known_;
};

TEST_F(CalibratedSourceTest, TakesThePlaceOfTheTakesOwn) {
  const auto source = open();
  ASSERT_TRUE(source) << source.error().context;
  const SourceInfo& info = (*source)->info();
  EXPECT_EQ(info.target.pinhole.fx_px, 61);
  EXPECT_EQ(info.tof.pinhole.cy_px, 22);
  EXPECT_EQ(info.target_from_tof.translation_m.x(), -0.05);
  EXPECT_EQ(info.frames, 6) << "other values are kept from the take";
  Capture frame;
  ASSERT_TRUE((*source)->read(1, frame));
  EXPECT_EQ(frame.depth_m.at(0, 0), 3.0F) << "no depth error, no correction";
}

TEST_F(CalibratedSourceTest, CorrectsDepthFrameByFrame) {
  known_.depth_error = calibration_file::DepthError{};
  known_.depth_error->knots_m = {1, 5};
  known_.depth_error->error_m = {0.02, 0.02};
  const auto source = open();
  ASSERT_TRUE(source);
  Capture frame;
  for (int number : {1, 2, 6}) {
    ASSERT_TRUE((*source)->read(number, frame));
    // On the optical axis depth is the distance.
    EXPECT_NEAR(frame.depth_m.at(33, 22), (number == 6 ? 2.0 : 3.0) - 0.02, 1e-6);
    EXPECT_GT(frame.depth_m.at(0, 0), 2.98F) << "off the axis less of the error is along z";
  }
}

TEST_F(CalibratedSourceTest, ReportsWhatIsMissingInOneLine) {
  const calibration_file::Calibration whole = known_;
  known_.cameras[0].name = "left", known_.cameras[1].name = "right";
  EXPECT_NE(error().find("\"target\" is missing, there are: left, right"), std::string::npos);
  known_ = whole;
  known_.cameras.pop_back();
  EXPECT_NE(error().find("\"tof\" is missing"), std::string::npos);
  known_ = whole;
  known_.poses.clear();
  EXPECT_NE(error().find("target_from"), std::string::npos);
  known_ = whole;
  known_.cameras[1].model = geometry::CameraModel{{{640, 480}, 510, 520, 330, 220}, {}};
  EXPECT_NE(error().find("640x480, these are 64x48"), std::string::npos);
  known_ = whole;
  known_.depth_error = calibration_file::DepthError{};
  known_.depth_error->knots_m = {1, 5}, known_.depth_error->error_m = {0, 0};
  known_.depth_error->camera = "other";
  EXPECT_NE(error().find("\"other\""), std::string::npos);
}

/// A box of which a second depth camera has the same depth.
class TwoDepthSource final : public CaptureSource {
 public:
  TwoDepthSource() : box_(5, 6), info_(box_.info()) { info_.tof2.emplace().model = info_.tof; }
  const SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, Capture& capture) override {
    MIXRIG_ASSIGN(const bool there, box_.read(number, capture));
    capture.depth2.depth_m = capture.depth_m;
    return there;
  }
  Result<void> read_truth(int, Truth&) override { return {}; }

 private:
  test::BoxSource box_;
  SourceInfo info_;
};

TEST_F(CalibratedSourceTest, ASecondDepthCameraHasItsOwnLensPlaceAndError) {
  const auto open_two = [&] {
    EXPECT_TRUE(calibration_file::write_calibration(file(), known_));
    return with_calibration(std::make_unique<TwoDepthSource>(), file());
  };
  EXPECT_NE(open_two().error().context.find("\"tof2\" is missing"), std::string::npos);
  known_.cameras.push_back(
      {"tof2", geometry::CameraModel{{{64, 48}, 55, 56, 31, 23}, {}}, {}, 0, 0, 0, {}});
  EXPECT_NE(open_two().error().context.find("target_from: \"tof2\""), std::string::npos);
  known_.poses.push_back({"tof2", {Eigen::Quaterniond::Identity(), {0.07, 0, 0}}, {}, 0, 0, {}});
  known_.depth_error2 = calibration_file::DepthError{};
  known_.depth_error2->knots_m = {1, 5}, known_.depth_error2->error_m = {0.03, 0.03};
  EXPECT_NE(open_two().error().context.find("depth_error2: is of camera \"tof\""),
            std::string::npos);
  known_.depth_error2->camera = "tof2";
  const auto source = open_two();
  ASSERT_TRUE(source) << source.error().context;
  EXPECT_EQ((*source)->info().tof2->model.pinhole.fx_px, 55);
  EXPECT_EQ((*source)->info().tof2->target_from_tof.translation_m.x(), 0.07);
  Capture frame;
  ASSERT_TRUE((*source)->read(1, frame));
  EXPECT_NEAR(frame.depth2.depth_m.at(31, 23), 3 - 0.03, 1e-6);
  EXPECT_EQ(frame.depth_m.at(31, 23), 3) << "the first one has no error";
}

TEST_F(CalibratedSourceTest, RefusesAFisheye) {
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(8);
  parameters.head<4>() << 20, 20, 31.5, 23.5;
  known_.cameras[0].model =
      geometry::make_camera(geometry::LensKind::kFisheye, {64, 48}, parameters);
  EXPECT_NE(error().find("fisheye"), std::string::npos);
}

TEST_F(CalibratedSourceTest, WithoutAFileTheSourceIsLeftAsItIs) {
  auto box = std::make_unique<test::BoxSource>(5, 6);
  const CaptureSource* const same = box.get();
  const auto source = with_calibration(std::move(box), {});
  ASSERT_TRUE(source);
  EXPECT_EQ(source->get(), same);
  const auto missing =
      with_calibration(std::make_unique<test::BoxSource>(5, 6), root_ / "none.toml");
  EXPECT_TRUE(test::refused(missing, {}, ErrorCode::kNotFound));
}

}  // namespace
}  // namespace mixrig::capture
