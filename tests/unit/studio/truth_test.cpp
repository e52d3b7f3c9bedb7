// SPDX-License-Identifier: Apache-2.0
// Ground truth is consistent: matte, depth, light, composite and labels of one frame.
#include <cmath>

#include <gtest/gtest.h>

#include "studio/sensors/lens.h"
#include "studio/studio.h"

namespace mixrig::studio {
namespace {

constexpr int kWidth = 128, kHeight = 104;

class TruthOfAWalk : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    StudioOptions o;
    o.rig = RigPreset::kSr3000;
    o.seed = 3;
    o.frames = 40;
    o.size_px = {kWidth, kHeight};
    auto studio = Studio::create(o);
    ASSERT_TRUE(studio);
    info_ = new StudioInfo(studio->info());
    empty_ = new Frame;
    empty_truth_ = new Truth;
    walking_ = new Frame;
    walking_truth_ = new Truth;
    studio->render(2, *empty_, empty_truth_);
    studio->render(36, *walking_, walking_truth_);
  }
  static void TearDownTestSuite() {
    delete info_, delete empty_, delete empty_truth_, delete walking_, delete walking_truth_;
  }
  static std::uint8_t layer(const Truth& t, int x, int y) { return t.labels.at(x, y) & 3U; }

  static inline StudioInfo* info_ = nullptr;
  static inline Frame *empty_ = nullptr, *walking_ = nullptr;
  static inline Truth *empty_truth_ = nullptr, *walking_truth_ = nullptr;
};

TEST_F(TruthOfAWalk, an_empty_frame_shows_no_person) {
  EXPECT_EQ(info_->empty_frames, 20);
  EXPECT_TRUE(empty_truth_->people.empty());
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      ASSERT_EQ(empty_truth_->matte.at(x, y), 0);
      ASSERT_EQ(empty_truth_->depth_m.at(x, y), empty_truth_->background_depth_m.at(x, y));
      ASSERT_NE(layer(*empty_truth_, x, y), Truth::kPerson);
    }
}

TEST_F(TruthOfAWalk, the_person_covers_as_much_as_a_person_does) {
  double area_m2 = 0;
  int whole = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double z = walking_truth_->depth_m.at(x, y),
                   share = walking_truth_->matte.at(x, y) / 255.0;
      area_m2 += share * z * z / (info_->view.fx_px * info_->view.fy_px);
      whole += walking_truth_->matte.at(x, y) == 255 ? 1 : 0;
    }
  // A walking adult's silhouette: some 0.45 to 0.75 square metres, a part may be out of view.
  EXPECT_GT(area_m2, 0.25);
  EXPECT_LT(area_m2, 0.95);
  EXPECT_GT(whole, 200);
}

TEST_F(TruthOfAWalk, the_person_is_before_the_background_and_changes_nothing_elsewhere) {
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float z = walking_truth_->depth_m.at(x, y),
                  behind = walking_truth_->background_depth_m.at(x, y);
      const int matte = walking_truth_->matte.at(x, y);
      if (matte == 255) {
        EXPECT_LT(z, behind);
      }
      if (matte == 0) {
        EXPECT_EQ(z, behind);
      }
    }
}

TEST_F(TruthOfAWalk, floor_path_moves_with_the_person) {
  ASSERT_EQ(walking_truth_->people.size(), 1U);
  const Eigen::Vector2d p = walking_truth_->people[0].on_floor_m;
  EXPECT_GT(p.x(), 1.5);
  EXPECT_LT(p.x(), 5.0);
  // The person is drawn at the position on the path: the matte's centre column is there.
  double column = 0, weight = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      column += x * walking_truth_->matte.at(x, y), weight += walking_truth_->matte.at(x, y);
  const Eigen::Vector3d seen =
      geometry::inverse(walking_->world_from_target) * Eigen::Vector3d(p.x(), p.y(), 1.0);
  EXPECT_NEAR(column / weight, info_->view.fx_px * seen.x() / seen.z() + info_->view.cx_px, 10);
}

TEST_F(TruthOfAWalk, the_object_only_removes_light_and_only_near_it) {
  int shaded = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float ratio = walking_truth_->light.at(x, y);
      EXPECT_GT(ratio, 0.1F);
      EXPECT_LE(ratio, 1.0F);
      shaded += ratio < 0.97F ? 1 : 0;
      if (y < kHeight / 8) {
        EXPECT_EQ(ratio, 1.0F);  // nothing shades the upper wall
      }
    }
  EXPECT_GT(shaded, 60);
}

TEST_F(TruthOfAWalk, composite_is_the_plate_where_nothing_is_virtual) {
  int checked = 0, far_off = 0;
  double difference = 0;
  for (int y = 4; y < kHeight - 4; ++y)
    for (int x = 4; x < kWidth - 4; ++x) {
      bool free = true, flat = true;
      const Rgb8 here = empty_truth_->composite.at(x, y);
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          free &= empty_truth_->light.at(x + i, y + j) == 1.0F &&
                  (empty_truth_->labels.at(x + i, y + j) & (3 | Truth::kSilhouette)) == 0;
          flat &= std::abs(empty_truth_->composite.at(x + i, y + j).g - here.g) < 6;
        }
      if (!free || !flat) continue;
      const Eigen::Vector2d px =
          project(info_->target, {(x - info_->view.cx_px) / info_->view.fx_px,
                                  (y - info_->view.cy_px) / info_->view.fy_px, 1});
      const Rgb8 plate = empty_->color.at(static_cast<int>(std::lround(px.x())),
                                          static_cast<int>(std::lround(px.y())));
      difference += plate.g - here.g;
      far_off += std::abs(plate.g - here.g) > 12 ? 1 : 0;
      ++checked;
    }
  EXPECT_GT(checked, 1000);
  EXPECT_NEAR(difference / checked, 0, 0.5);
  EXPECT_LT(far_off, 0.03 * checked);  // fine textures, sampled half a pixel apart
}

TEST_F(TruthOfAWalk, silhouette_holds_what_is_visible_of_the_object) {
  int visible = 0;
  for (const Truth* t : {empty_truth_, walking_truth_})
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (layer(*t, x, y) == Truth::kVirtual) {
          ++visible;
          EXPECT_TRUE(t->labels.at(x, y) & Truth::kSilhouette);
        }
  EXPECT_GT(visible, 400);
}

TEST(Truth, people_pass_before_the_object_and_behind_it) {
  StudioOptions o;
  o.rig = RigPreset::kSr3000;
  o.seed = 3;
  o.frames = 400;
  o.size_px = {64, 52};
  auto studio = Studio::create(o);
  ASSERT_TRUE(studio);
  Frame frame;
  Truth truth;
  int before = 0, behind = 0;
  for (int number = 30; number < 230; number += 8) {
    studio->render(number, frame, &truth);
    for (int y = 0; y < 52; ++y)
      for (int x = 0; x < 64; ++x) {
        const int label = truth.labels.at(x, y);
        if ((label & Truth::kSilhouette) == 0 || truth.matte.at(x, y) < 255) continue;
        before += (label & 3) == Truth::kPerson ? 1 : 0;
        behind += (label & 3) == Truth::kVirtual ? 1 : 0;
      }
  }
  EXPECT_GT(before, 30);
  EXPECT_GT(behind, 30);
}

}  // namespace
}  // namespace mixrig::studio
