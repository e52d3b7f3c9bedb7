// SPDX-License-Identifier: Apache-2.0
// Counts and reports of the lenses of frames.
#include "host/room/background/frame_lens.h"

#include <gtest/gtest.h>

namespace mixrig::session {
namespace {

using capture::LensOrigin;

class LensWatchTest : public ::testing::Test {
 protected:
  LensWatchTest() {
    setup_.target.pinhole = {{160, 120}, 130, 130, 79.5, 59.5};
    setup_.view = setup_.target.pinhole;
    learned_.view = setup_.view;
    learned_.world_from_view = geometry::Pose{};
  }
  capture::Capture frame(int number, double zoom, LensOrigin origin = LensOrigin::kEncoded) const {
    capture::Capture capture;
    capture.number = number;
    capture.encoders = geometry::LensEncoders{zoom, 0};
    capture.lens = capture::FrameLens{{setup_.target, 0}, origin};
    geometry::Pinhole& p = capture.lens->state.camera.pinhole;
    p.fx_px *= zoom, p.fy_px *= zoom;
    return capture;
  }
  render::CompositorSetup setup_;
  model::StaticBackground learned_;
};

TEST_F(LensWatchTest, CountsWhereTheLensesComeFrom) {
  LensWatch watch(setup_, &learned_);
  capture::Capture fixed = frame(1, 1);
  fixed.lens.reset();
  watch.add(fixed, {});
  EXPECT_FALSE(watch.report());
  for (const auto& [number, zoom, origin] :
       {std::tuple(1, 1.0, LensOrigin::kEncoded), std::tuple(2, 1.5, LensOrigin::kEncoded),
        std::tuple(3, 1.5, LensOrigin::kHeld), std::tuple(4, 2.0, LensOrigin::kClamped),
        std::tuple(5, 2.0, LensOrigin::kClamped)})
    watch.add(frame(number, zoom, origin), {});
  ASSERT_TRUE(watch.report());
  const LensReport& report = *watch.report();
  EXPECT_EQ(report.frames, (std::array<std::uint64_t, capture::kLensOrigins>{0, 2, 2, 1}));
  EXPECT_EQ(report.changed, 2U);
  EXPECT_EQ(report.beyond_background, 0U);
  EXPECT_DOUBLE_EQ(report.least_fx_px, 130);
  EXPECT_DOUBLE_EQ(report.most_fx_px, 260);
}

TEST_F(LensWatchTest, CountsWhatShowsMoreThanWasLearned) {
  LensWatch watch(setup_, &learned_), of_room(setup_, nullptr);
  int number = 0;
  for (const double zoom : {1.0, 0.99, 0.9, 1.2}) {
    watch.add(frame(++number, zoom), {});
    of_room.add(frame(number, zoom), {});
  }
  EXPECT_EQ(watch.report()->beyond_background, 1U) << "1 % is within the margin";
  EXPECT_EQ(of_room.report()->beyond_background, 0U);
  // Zoomed in, but turned away from what was learned.
  const geometry::Pose turned{Eigen::Quaterniond(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitY())),
                              {0, 0, 0}};
  watch.add(frame(++number, 1.5), turned);
  EXPECT_EQ(watch.report()->beyond_background, 2U);
}

}  // namespace
}  // namespace mixrig::session
