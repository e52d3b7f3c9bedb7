// SPDX-License-Identifier: Apache-2.0
// The lens of each capture: between the encoders' values in time, and by the calibration's table.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "host/capture/calibration_file/calibration.h"
#include "host/capture/capture/calibrated_source.h"
#include "host/capture/capture/lens_track.h"
#include "tests/support/box_source.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::capture {
namespace {

HostTime at_ms(double ms) { return HostTime(Duration(std::llround(ms * 1e6))); }

TEST(LensTrack, IsLinearBetweenSamplesAndEndsWhereTheyDo) {
  const std::vector<LensSample> samples = {
      {at_ms(-40), {100, 7}}, {at_ms(0), {200, 9}}, {at_ms(300), {900, 1}}};
  const auto zoom = [&](double ms) {
    const auto at = lens_at(samples, at_ms(ms));
    return at ? at->zoom : -1;
  };
  EXPECT_DOUBLE_EQ(zoom(-40), 100);
  EXPECT_DOUBLE_EQ(zoom(-10), 175);
  EXPECT_DOUBLE_EQ(lens_at(samples, at_ms(-10))->focus, 8.5);
  EXPECT_DOUBLE_EQ(zoom(0), 200);
  EXPECT_EQ(zoom(150), -1) << "a gap of 300 ms is not interpolated over";
  EXPECT_DOUBLE_EQ(zoom(-85), 100);
  EXPECT_EQ(zoom(-95), -1);
  EXPECT_DOUBLE_EQ(zoom(340), 900);
  EXPECT_EQ(zoom(360), -1);
  EXPECT_FALSE(lens_at({}, at_ms(0)));
  const std::vector<LensSample> far = {{HostTime::min(), {1, 1}}, {HostTime::max(), {2, 2}}};
  EXPECT_FALSE(lens_at(far, at_ms(0)));
}

/// A source with given encoder values for each frame; frames without an entry have none.
class EncodedSource final : public CaptureSource {
 public:
  explicit EncodedSource(std::map<int, geometry::LensEncoders> encoders)
      : encoders_(std::move(encoders)), box_(5, 9), info_(box_.info()) {
    info_.has_lens_values = !encoders_.empty();
  }
  const SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, Capture& capture) override {
    const auto there = box_.read(number, capture);
    capture.encoders.reset();
    if (const auto at = encoders_.find(number); at != encoders_.end())
      capture.encoders = at->second;
    return there;
  }
  Result<void> read_truth(int number, Truth& truth) override {
    return box_.read_truth(number, truth);
  }

 private:
  std::map<int, geometry::LensEncoders> encoders_;
  test::BoxSource box_;
  SourceInfo info_;
};

class CaptureLens : public ::testing::Test {
 protected:
  /// Zoom 0 to 100 doubles a focal length of 61 px; focus 0 to 10 adds 1 %.
  static geometry::LensState lens(double zoom, double focus) {
    const double f = 61 * std::pow(2, zoom / 100) * (1 + 0.001 * focus);
    return {{{{64, 48}, f, f, 30, 20}, {}}, 1e-4 * zoom};
  }
  std::unique_ptr<CaptureSource> open(std::map<int, geometry::LensEncoders> encoders) {
    std::vector<geometry::LensNode> nodes;
    for (const double zoom : {0.0, 50.0, 100.0})
      for (const double focus : {0.0, 10.0}) nodes.push_back({{zoom, focus}, lens(zoom, focus), 0});
    calibration_file::Calibration known;
    known.cameras = {{"target", lens(0, 0).camera, {}, 0, 0, 0, {}},
                     {"tof", lens(0, 0).camera, {}, 0, 0, 0, {}}};
    known.cameras[0].lens = *geometry::LensTable::make(nodes);
    known.poses = {{"tof", {}, {}, 0, 0, {}}};
    EXPECT_TRUE(calibration_file::write_calibration(folder_ / "c.toml", known));
    auto source =
        with_calibration(std::make_unique<EncodedSource>(std::move(encoders)), folder_ / "c.toml");
    EXPECT_TRUE(source) << source.error().context;
    return source ? *std::move(source) : nullptr;
  }
  const test::TemporaryFolder folder_;
};

TEST_F(CaptureLens, IsThatOfTheTableAtWhatTheEncodersSay) {
  const auto source = open({{1, {0, 0}}, {2, {50, 10}}, {3, {120, -4}}, {5, {25, 5}}});
  ASSERT_TRUE(source);
  EXPECT_TRUE(source->info().lens);
  Capture frame;
  ASSERT_TRUE(source->read(1, frame));
  ASSERT_TRUE(frame.lens);
  EXPECT_EQ(frame.lens->origin, LensOrigin::kEncoded);
  EXPECT_NEAR(frame.lens->state.camera.pinhole.fx_px, 61, 1e-9);
  ASSERT_TRUE(source->read(2, frame));
  EXPECT_NEAR(frame.lens->state.camera.pinhole.fx_px, lens(50, 10).camera.pinhole.fx_px, 1e-9);
  EXPECT_NEAR(frame.lens->state.pupil_shift_m, 0.005, 1e-12);
  ASSERT_TRUE(source->read(3, frame));
  EXPECT_EQ(frame.lens->origin, LensOrigin::kClamped);
  EXPECT_NEAR(frame.lens->state.camera.pinhole.fx_px, 122, 1e-9);
  ASSERT_TRUE(source->read(4, frame));
  EXPECT_EQ(frame.lens->origin, LensOrigin::kHeld);
  EXPECT_NEAR(frame.lens->state.camera.pinhole.fx_px, 122, 1e-9);
  ASSERT_TRUE(source->read(5, frame));
  EXPECT_EQ(frame.lens->origin, LensOrigin::kEncoded);
  EXPECT_NEAR(frame.lens->state.camera.pinhole.fx_px, lens(25, 5).camera.pinhole.fx_px, 0.05);
}

TEST_F(CaptureLens, StandsStillThroughTheNoiseOfItsEncoders) {
  const auto source = open({{1, {50, 5}}, {2, {50.05, 5}}, {3, {49.96, 5}}, {4, {51, 5}}});
  ASSERT_TRUE(source);
  Capture frame;
  ASSERT_TRUE(source->read(1, frame));
  const double first_px = frame.lens->state.camera.pinhole.fx_px;
  for (const int number : {2, 3}) {
    ASSERT_TRUE(source->read(number, frame));
    EXPECT_EQ(frame.lens->state.camera.pinhole.fx_px, first_px);
  }
  ASSERT_TRUE(source->read(4, frame));
  EXPECT_GT(frame.lens->state.camera.pinhole.fx_px, 1.004 * first_px);
}

TEST_F(CaptureLens, IsFixedWithoutEncoders) {
  const auto source = open({});
  ASSERT_TRUE(source);
  EXPECT_FALSE(source->info().lens);
  Capture frame;
  ASSERT_TRUE(source->read(1, frame));
  EXPECT_FALSE(frame.lens);
}

}  // namespace
}  // namespace mixrig::capture
