// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/scraps.h"

#include <gtest/gtest.h>

namespace mixrig::measure {
namespace {

constexpr Size kScrapsSize{320, 256};  // a scrap has at least 2 pixels here

/// An object over the middle of the picture, before a person on its right half.
struct ScrapScene {
  Image<std::uint8_t> labels{kScrapsSize}, layer{kScrapsSize}, matte{kScrapsSize};
  ScrapScene() {
    for (int y = 0; y < kScrapsSize.height; ++y)
      for (int x = 0; x < kScrapsSize.width; ++x) {
        const bool object = x >= 100 && x < 200 && y >= 80 && y < 180, person = x >= 150;
        const int visible = object ? kLayerVirtual : person;
        labels.at(x, y) = static_cast<std::uint8_t>(visible | (object ? kInSilhouette : 0));
        layer.at(x, y) = static_cast<std::uint8_t>(visible);
        matte.at(x, y) = person ? 255 : 0;
      }
  }
  void show(int layer_shown, int x0, int y0, int width, int height) {
    for (int y = y0; y < y0 + height; ++y)
      for (int x = x0; x < x0 + width; ++x) layer.at(x, y) = static_cast<std::uint8_t>(layer_shown);
  }
  TruthImages truth() const { return {{}, {}, matte, {}, labels}; }
};

Errors::Scraps judged_scraps(const ScrapScene& scene) {
  ScrapJudge judge;
  judge.add(scene.layer, scene.matte, scene.truth());
  return scraps_of(judge.sums());
}

TEST(Scraps, no_frame_is_nothing_and_a_right_one_is_zero) {
  EXPECT_EQ(scraps_of({}).specks, std::nullopt);
  const Errors::Scraps s = judged_scraps(ScrapScene());
  EXPECT_EQ(s.person_through_object, 0.0);
  EXPECT_EQ(s.object_through_person, 0.0);
  EXPECT_EQ(s.room_through, 0.0);
  EXPECT_EQ(s.over_room, 0.0);
  EXPECT_EQ(s.specks, 0.0);
  EXPECT_EQ(s.ghost_pixels, 0.0);
}

TEST(Scraps, pieces_are_counted_by_what_shows_through) {
  ScrapScene scene;
  scene.show(1, 160, 100, 7, 3);  // the person through the object
  scene.show(1, 180, 100, 2, 2);
  scene.show(0, 120, 120, 5, 2);  // the room through it
  scene.show(1, 190, 150, 1, 1);  // a speck
  scene.show(2, 250, 200, 3, 3);  // the object where the person is visible
  scene.show(2, 20, 20, 3, 3);    // and where the room is
  ScrapJudge judge;
  judge.add(scene.layer, scene.matte, scene.truth());
  const Errors::Scraps s = scraps_of(judge.sums());
  EXPECT_EQ(s.person_through_object, 2.0);
  EXPECT_EQ(s.object_through_person, 1.0);
  EXPECT_EQ(s.room_through, 1.0);
  EXPECT_EQ(s.over_room, 1.0);
  EXPECT_EQ(s.specks, 1.0);
  EXPECT_EQ(s.pixels, 21.0 + 4 + 10 + 9 + 9);
  EXPECT_EQ(s.largest_px, 21.0);
  EXPECT_EQ(judge.worst().kind, Scrap::kPersonThroughObject);
  EXPECT_EQ(judge.worst().x_px, 160);
  EXPECT_EQ(judge.worst().y_px, 100);
  EXPECT_EQ(judge.worst().width_px, 7);
  EXPECT_EQ(judge.worst().height_px, 3);
}

TEST(Scraps, border_one_pixel_off_is_none_and_two_pixels_off_are_one) {
  ScrapScene one, two;
  one.show(2, 200, 80, 1, 100);
  EXPECT_EQ(judged_scraps(one).object_through_person, 0.0);
  EXPECT_EQ(judged_scraps(one).specks, 0.0);
  two.show(2, 200, 80, 2, 100);
  EXPECT_EQ(judged_scraps(two).object_through_person, 1.0);
}

TEST(Scraps, what_comes_and_goes_is_counted_apart) {
  ScrapScene right, wrong;
  wrong.show(1, 160, 100, 7, 3);
  ScrapJudge judge;
  for (int i = 0; i < 4; ++i) {
    const ScrapScene& scene = i % 2 == 0 ? right : wrong;
    judge.add(scene.layer, scene.matte, scene.truth());
  }
  EXPECT_EQ(scraps_of(judge.sums()).changed_pixels, 3 * 21 / 4.0);
  EXPECT_EQ(judge.worst().pixels, 21);
}

TEST(Scraps, ghost_is_half_a_person_far_from_the_border) {
  ScrapScene scene;
  Image<std::uint8_t> matte(kScrapsSize);
  for (int y = 0; y < kScrapsSize.height; ++y)
    std::copy_n(scene.matte.row(y), kScrapsSize.width, matte.row(y));
  for (int x = 140; x < 160; ++x) matte.at(x, 10) = 128;  // along the border
  for (int x = 20; x < 25; ++x) matte.at(x, 30) = 128;
  for (int x = 20; x < 25; ++x) matte.at(x, 40) = 20;
  ScrapJudge judge;
  judge.add(scene.layer, matte, scene.truth());
  EXPECT_EQ(scraps_of(judge.sums()).ghost_pixels, 5.0 + 2.0);
}

}  // namespace
}  // namespace mixrig::measure
