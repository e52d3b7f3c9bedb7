// SPDX-License-Identifier: Apache-2.0
// The camera's look (blur, grain, chroma) is followed during a run, by the time of its frames.
#include "host/run/watchers/look_keeper.h"

#include <array>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"

namespace mixrig::session {
namespace {

using render::PictureLook;

constexpr double kLookFrame_s = 0.04;
constexpr int kLookFrames_s = 25;

PictureLook look_of(float blur_px, float noise = 1e-5F) {
  PictureLook look;
  look.grain.floor = glm::vec3(noise), look.blur_px = blur_px;
  return look;
}

/// One of every LookKeeper::kLookStep plates is measured.
struct Followed {
  LookFollower follower;
  int frame = 0;
  float largest_step_px = 0;
  float run(int frames, const PictureLook& shown) {
    float last = frame == 0 ? shown.blur_px : follower.at(kLookFrame_s * frame).blur_px;
    for (int i = 0; i < frames; ++i, ++frame) {
      if (frame % LookKeeper::kLookStep == 0) follower.add(shown);
      const float now = follower.at(kLookFrame_s * frame).blur_px;
      largest_step_px = std::max(largest_step_px, std::abs(now - last));
      last = now;
    }
    return last;
  }
};

TEST(LookFollower, FollowsWithinASecondWithoutAStep) {
  Followed f;
  EXPECT_FLOAT_EQ(f.run(20, look_of(0.4F)), 0.4F);
  EXPECT_NEAR(f.run(kLookFrames_s, look_of(1.0F, 4e-5F)), 1.0F, 0.06F);
  EXPECT_LT(f.largest_step_px, 0.2F) << "of 0.6";
  EXPECT_NEAR(f.follower.at(10).grain.floor.y, 4e-5F, 2e-6F);
  f.run(kLookFrames_s, look_of(1.0F, 4e-5F));
  EXPECT_EQ(f.follower.at(20), f.follower.aim()) << "it has come to rest";
}

TEST(LookFollower, OneOddPlateAndSmallChangesAreNone) {
  Followed f;
  f.run(20, look_of(0.5F));
  f.follower.add(look_of(1.2F));
  f.follower.add(look_of(0.53F, 1.1e-5F));
  f.follower.add(look_of(0.47F, 0.95e-5F));
  EXPECT_EQ(f.follower.at(2), look_of(0.5F));
}

TEST(LookFollower, TakesMotionOutOfTheFirstPlate) {
  LookFollower follower;
  follower.add(look_of(std::sqrt(0.25F + 4.0F / 24)));
  follower.take_motion_out({2, 0});
  (void)follower.at(0);
  EXPECT_NEAR(follower.at(0.24).blur_px, 0.5F, 0.02F);
  follower.take_motion_out({20, 0});
  EXPECT_EQ(follower.aim().blur_px, 0);
}

/// A step behind a lens of this blur, over the area of pixels and a way while
/// it is exposed, by its distance.
class Edge {
 public:
  Edge(float blur_px, float way_px) {
    constexpr int kTaps = 16, kAcross = 4;
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const float d = static_cast<float>(i) / kPerPixel - kReach_px;
      for (int k = 0; k < kTaps * kAcross; ++k) {
        const float way = (static_cast<float>(k / kAcross) + 0.5F) / kTaps - 0.5F;
        const float across = (static_cast<float>(k % kAcross) + 0.5F) / kAcross - 0.5F;
        const float at = (d + way_px * way + across) / (blur_px * std::sqrt(2.0F));
        table_[i] += 0.5F * std::erfc(-at) / (kTaps * kAcross);
      }
    }
  }
  float at(float d_px) const {
    return table_[static_cast<std::size_t>((d_px + kReach_px) * kPerPixel + 0.5F)];
  }

 private:
  static constexpr int kPerPixel = 50, kReach_px = 16;
  std::array<float, 2 * kReach_px * kPerPixel + 1> table_{};
};

/// Upright and level steps; the camera moves across.
Image<Rgb8> plate_of(float blur_px, float way_px, unsigned seed) {
  constexpr int kBlock_px = 24;
  constexpr float kNoise = 0.012F;
  Image<Rgb8> plate({320, 240});
  std::mt19937 random(seed);
  const auto noise = [&] {
    return kNoise * (static_cast<float>(random() & 0xFFFF) / 0xFFFF - 0.5F);
  };
  const Edge across(blur_px, way_px), down(blur_px, 0);
  for (int y = 0; y < plate.height(); ++y)
    for (int x = 0; x < plate.width(); ++x) {
      const int column = x / kBlock_px, row = y / kBlock_px;
      const float place = 10.9F + 0.07F * static_cast<float>((5 * column + 3 * row) % 13);
      const bool upright = (column + row) % 2 == 0;
      const float d = static_cast<float>(upright ? x % kBlock_px : y % kBlock_px) - place;
      const float light = 0.2F + 0.4F * (upright ? across : down).at(d);
      plate.row(y)[x] = {srgb_byte_from_linear(light + noise()),
                         srgb_byte_from_linear(light + noise()),
                         srgb_byte_from_linear(light + noise())};
    }
  return plate;
}

class Turning final : public capture::PoseSource {
 public:
  Turning() : PoseSource({"turning", "turns"}) {}
  capture::CameraPose pose_of(const capture::Capture&) override { return {}; }
};

class LookKeeperTest : public ::testing::Test {
 protected:
  LookKeeperTest() {
    session_.setup.target.pinhole = {{320, 240}, 300, 300, 159.5, 119.5};
    session_.setup.view = session_.setup.target.pinhole;
    session_.setup.look = {.grain = true, .blur = true, .motion = true};
    session_.setup.objects.emplace_back();
  }
  /// Shows frames; what is in use after the last one.
  PictureLook show(LookKeeper& keeper, int frames, float blur_px, float way_px) {
    PictureLook used;
    for (int i = 0; i < frames; ++i) {
      ++number_;
      auto capture = std::make_shared<capture::Capture>();
      capture->number = number_, capture->time_s = kLookFrame_s * number_;
      capture->plate = plate_of(blur_px, way_px, static_cast<unsigned>(number_));
      auto composite = std::make_shared<output::Composite>();
      composite->capture = std::move(capture);
      composite->view = session_.setup.view;
      // The first frame of a run is composited before any motion is known.
      if (number_ > 1)
        composite->motion = render::CameraMotion{.turn_rad = {0, way_px / 300, 0}, .shift_m = {}};
      used = *keeper.look_of(*composite);
      EXPECT_TRUE(keeper.push(composite));
    }
    return used;
  }

  Session session_;
  int number_ = 0;
};

TEST_F(LookKeeperTest, FollowsALensThatIsFocusedAnew) {
  LookKeeper keeper(session_, false);
  keeper.open(nullptr);
  const PictureLook first = show(keeper, 20, 0.4F, 0);
  EXPECT_NEAR(first.blur_px, 0.4F, 0.15F);
  const PictureLook then = show(keeper, kLookFrames_s, 0.9F, 0);
  EXPECT_NEAR(then.blur_px, 0.9F, 0.12F);
  const PictureLook again = show(keeper, kLookFrames_s, 0.4F, 0);
  EXPECT_NEAR(again.blur_px, first.blur_px, 0.08F);
  ASSERT_TRUE(keeper.finish());
  EXPECT_GE(keeper.report()->looks, 8);
  EXPECT_EQ(keeper.report()->moved, 0);
}

TEST_F(LookKeeperTest, ACameraThatMovesDoesNotBlurTheLook) {
  session_.poses = std::make_unique<Turning>();
  LookKeeper keeper(session_, false);
  keeper.open(nullptr);
  const PictureLook still = show(keeper, 10, 0.5F, 0);
  const PictureLook moving = show(keeper, 2 * kLookFrames_s, 0.5F, 2.5F);
  EXPECT_NEAR(moving.blur_px, still.blur_px, 0.01F);
  ASSERT_TRUE(keeper.finish());
  EXPECT_GT(keeper.report()->moved, kLookFrames_s);
  // Plates at rest show no more blur than that of the lens.
  LookKeeper from_motion(session_, false);
  from_motion.open(nullptr);
  number_ = 0;
  const PictureLook first = show(from_motion, 1, 0.5F, 2.0F);
  const PictureLook second = show(from_motion, 15, 0.5F, 2.0F);
  EXPECT_LT(second.blur_px, first.blur_px - 0.05F);
  EXPECT_NEAR(show(from_motion, kLookFrames_s, 0.5F, 0).blur_px, 0.5F, 0.12F);
  ASSERT_TRUE(from_motion.finish());
}

/// Nothing is found there: what was known stays.
TEST_F(LookKeeperTest, PlatesWithoutStepsChangeNothing) {
  LookKeeper keeper(session_, false);
  keeper.open(nullptr);
  const PictureLook first = show(keeper, 3, 0.6F, 0);
  EXPECT_EQ(show(keeper, kLookFrames_s, 40.0F, 0).blur_px, first.blur_px);
  ASSERT_TRUE(keeper.finish());
}

TEST_F(LookKeeperTest, StaysClosedWhereNothingIsWanted) {
  session_.scene.look.follow = false;
  LookKeeper keeper(session_, false);
  keeper.open(nullptr);
  EXPECT_EQ(keeper.look_of({}), nullptr);
  const auto composite = std::make_shared<output::Composite>();
  composite->capture = std::make_shared<capture::Capture>();
  EXPECT_TRUE(keeper.push(composite));
  EXPECT_FALSE(keeper.report());
}

TEST(WayOfView, IsThatOfTheFastestPart) {
  const geometry::Pinhole view{{640, 480}, 600, 600, 319.5, 239.5};
  const glm::vec2 turn = way_of_view_px({.turn_rad = {0, 0.001F, 0}, .shift_m = {}}, view);
  EXPECT_NEAR(glm::length(turn), 0.6F * (1 + 0.28F), 0.02F) << "more at the sides";
  const glm::vec2 shift = way_of_view_px({.turn_rad = {}, .shift_m = {0.002F, 0, 0}}, view);
  EXPECT_NEAR(glm::length(shift), 600 * 0.002F / 2, 1e-4F) << "of what is two metres away";
}

}  // namespace
}  // namespace mixrig::session
