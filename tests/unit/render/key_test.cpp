// SPDX-License-Identifier: Apache-2.0
// The key of the back end under test, on small pictures made by hand.
#include <cmath>
#include <utility>

#include "tests/unit/render/back_end.h"
#include "tests/unit/render/helpers.h"

namespace mixrig::test {
namespace {

constexpr Size kKeyView{64, 64};
const Rgbf kWall{0.5F, 0.5F, 0.5F}, kShirt{0.6F, 0.1F, 0.1F};

/// A wall 4 m away; people are painted into depth and plate by the tests.
struct Keyed {
  Keyed()
      : setup(plain_setup(kKeyView, 64, {32, 32}, 32)),
        depth(kKeyView, 4),
        sigma(kKeyView, 0.002F) {
    color.reset(kKeyView, kWall);
    color_sigma.reset(kKeyView, 0.01F);
    plate.reset(kKeyView, kWall);
    w.reset(kKeyView, 0.25F);
  }
  void person(int x0, int y0, int x1, int y1, float z_m = 2) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) w.at(x, y) = 1 / z_m;
  }
  void paint(int x0, int y0, int x1, int y1, Rgbf c) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) plate.at(x, y) = c;
  }
  void run(bool use_color = true) {
    setup.background = {depth, sigma, color, color_sigma};
    setup.key.color = use_color;
    matte = key_people(setup, plate, w);
  }
  bool is_person(int x, int y) const { return matte.at(x, y) >= 128; }
  int people() const {
    int n = 0;
    for (int y = 0; y < kKeyView.height; ++y)
      for (int x = 0; x < kKeyView.width; ++x) n += is_person(x, y);
    return n;
  }
  render::CompositorSetup setup;
  Image<float> depth, sigma, color_sigma, w;
  Image<Rgbf> color, plate;
  Image<std::uint8_t> matte;
};

TEST(Key, depth_alone_decides_without_colour) {
  Keyed k;
  k.person(16, 16, 48, 48);
  k.run(false);
  EXPECT_NEAR(k.people(), 32 * 32, 64);
  EXPECT_TRUE(k.is_person(32, 32));
}

TEST(Key, less_than_the_threshold_before_the_wall_is_background) {
  Keyed k;
  k.person(16, 16, 48, 48, 3.97F);
  k.run();
  EXPECT_EQ(k.people(), 0);
}

TEST(Key, colour_moves_a_border_that_depth_put_a_pixel_off) {
  Keyed k;
  k.person(17, 16, 45, 48);
  k.paint(16, 16, 44, 48, kShirt);
  k.run();
  EXPECT_TRUE(k.is_person(16, 32));
  EXPECT_TRUE(k.is_person(43, 32));
  EXPECT_FALSE(k.is_person(44, 32));
  EXPECT_FALSE(k.is_person(15, 32));
}

TEST(Key, person_in_the_colour_of_the_wall_is_kept_by_depth) {
  Keyed k;
  k.person(16, 16, 48, 48);
  k.run();
  EXPECT_NEAR(k.people(), 32 * 32, 140);
  for (int i = 20; i < 44; ++i) EXPECT_TRUE(k.is_person(i, 32));
}

TEST(Key, shadow_of_a_person_on_the_wall_stays_background) {
  Keyed k;
  k.person(16, 16, 40, 48);
  k.paint(16, 16, 40, 48, kShirt);
  k.paint(40, 16, 56, 48, {0.35F, 0.35F, 0.35F});
  k.run();
  for (int x = 42; x < 64; ++x) EXPECT_FALSE(k.is_person(x, 32)) << x;
}

TEST(Key, unknown_depth_beside_a_person_is_decided_by_colour) {
  Keyed k;
  k.person(16, 16, 32, 48);
  k.paint(16, 16, 40, 48, kShirt);
  for (int y = 16; y < 48; ++y)
    for (int x = 32; x < 48; ++x) k.w.at(x, y) = 0;  // dark half of the shirt, then a blind strip
  k.run();
  EXPECT_TRUE(k.is_person(36, 32));
  EXPECT_FALSE(k.is_person(44, 32));
  EXPECT_NEAR(k.w.at(36, 32), 0.5F, 1e-3F) << "takes the depth of the person beside it";
}

TEST(Key, refined_matte_is_half_where_a_pixel_is_half_a_person) {
  Keyed k;
  k.person(16, 0, 40, 64);
  k.paint(16, 0, 40, 64, kShirt);
  const Rgbf half{(kWall.r + kShirt.r) / 2, (kWall.g + kShirt.g) / 2, (kWall.b + kShirt.b) / 2};
  k.paint(40, 0, 41, 64, half);
  k.run();
  // Colour is a line of the matte; its square root is bent, by 0.1 at most here.
  EXPECT_NEAR(k.matte.at(40, 32) / 255.0, 0.5, 0.2);
  EXPECT_GT(k.matte.at(38, 32), 230);
  EXPECT_LT(k.matte.at(43, 32), 26);
  k.setup.key.refine = false;
  k.person(16, 0, 40, 64);
  k.run();
  EXPECT_TRUE(k.matte.at(40, 32) == 0 || k.matte.at(40, 32) == 255) << "votes are nearly binary";
}

TEST(Key, what_is_measured_nearer_is_kept_where_the_background_has_no_depth) {
  Keyed k;
  k.person(16, 16, 48, 48);
  k.paint(16, 16, 48, 48, kShirt);
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 64; ++x) k.depth.at(x, y) = 0;
  k.person(38, 30, 42, 34, 1.2F);
  k.run();
  EXPECT_TRUE(k.is_person(40, 32));
  EXPECT_NEAR(1 / k.w.at(40, 32), 1.2, 1e-3) << "not the mean depth of the person around";
}

/// A person 3 m away whom one at 2 m hides in part, and a strip without depth between both.
struct TwoPeople : Keyed {
  explicit TwoPeople(int strip_px, double baseline_m) {
    setup.target_from_tof.translation_m.x() = baseline_m;
    person(8, 16, 32 - strip_px, 48, 3), person(32, 16, 52, 48, 2);
    for (int y = 16; y < 48; ++y)
      for (int x = 32 - strip_px; x < 32; ++x) w.at(x, y) = 0;
    paint(8, 16, 52, 48, kShirt);
    run();
  }
  float z_m(int x) const { return 1 / w.at(x, 32); }
};

TEST(Key, what_the_nearer_of_two_people_hides_from_the_tof_camera_is_the_rear_one) {
  const TwoPeople narrow(3, 0);
  for (int x = 29; x < 32; ++x) EXPECT_FLOAT_EQ(narrow.z_m(x), 3) << x;
  // 64 px x 0.2 m x (1 / 2 m - 1 / 3 m) = 2.1 px are hidden; with slack 5 px may be.
  const TwoPeople wide(5, 0.2);
  for (int x = 27; x < 32; ++x) EXPECT_FLOAT_EQ(wide.z_m(x), 3) << x;
}

TEST(Key, foreground_that_is_the_room_by_colour_gives_nobody_its_depth) {
  Keyed k;
  k.setup.target_from_tof.translation_m.x() = 0.2;
  k.person(22, 16, 26, 48, 3.5F), k.person(32, 16, 52, 48, 2);
  for (int y = 16; y < 48; ++y)
    for (int x = 26; x < 32; ++x) k.w.at(x, y) = 0;
  k.paint(26, 16, 52, 48, kShirt);
  k.run();
  EXPECT_FALSE(k.is_person(23, 32));
  for (int x = 27; x < 32; ++x) {
    EXPECT_TRUE(k.is_person(x, 32)) << x;
    EXPECT_FLOAT_EQ(1 / k.w.at(x, 32), 2) << x;
  }
}

/// Depth, m, of people 2 m away beside a strip 3.5 m away whose colour is the shirt's to `part` and
/// the wall's for the rest. Parallax may hide the place where it is read.
float depth_beside_a_strip_m(float part) {
  Keyed k;
  k.setup.target_from_tof.translation_m.x() = 0.2;
  k.person(22, 16, 26, 48, 3.5F), k.person(32, 16, 52, 48, 2);
  for (int y = 16; y < 48; ++y)
    for (int x = 26; x < 32; ++x) k.w.at(x, y) = 0;
  const auto between = [part](float wall, float shirt) { return wall + part * (shirt - wall); };
  k.paint(22, 16, 26, 48,
          {between(kWall.r, kShirt.r), between(kWall.g, kShirt.g), between(kWall.b, kShirt.b)});
  k.paint(26, 16, 52, 48, kShirt);
  k.run();
  return 1 / k.w.at(30, 32);
}

TEST(Key, only_surely_people_put_what_is_beside_them_behind_a_nearer_person) {
  EXPECT_FLOAT_EQ(depth_beside_a_strip_m(0.4F), 2) << "matte of the strip 0.6 to 0.7";
  EXPECT_FLOAT_EQ(depth_beside_a_strip_m(1), 3.5F);
}

TEST(Key, depth_that_parallax_does_not_explain_is_that_of_the_nearer_pixel) {
  const TwoPeople k(6, 0);
  for (int x = 26; x < 29; ++x) EXPECT_FLOAT_EQ(k.z_m(x), 3) << x;
  for (int x = 29; x < 32; ++x) EXPECT_FLOAT_EQ(k.z_m(x), 2) << x;
}

/// Samples at borders measure a limb and what lies behind it, and have the depth of neither.
TEST(Key, depth_of_a_cut_cell_counts_only_with_whole_cells_of_its_depth) {
  Keyed k;
  k.person(16, 16, 48, 48);
  k.paint(16, 16, 48, 48, kShirt);
  k.person(44, 20, 48, 24, -1.5F), k.person(44, 28, 48, 32, -3.2F), k.person(44, 36, 48, 40, -2.1F);
  k.run();
  EXPECT_FLOAT_EQ(1 / k.w.at(46, 22), 2) << "nearer than the person";
  EXPECT_FLOAT_EQ(1 / k.w.at(46, 30), 2) << "farther than the person";
  EXPECT_FLOAT_EQ(1 / k.w.at(46, 38), 2.1F) << "near that of the person";
}

TEST(Key, people_without_whole_cells_keep_their_depth) {
  Keyed k;
  k.person(16, 16, 48, 48, -2);
  k.paint(16, 16, 48, 48, kShirt);
  k.person(40, 16, 48, 48, -1.5F);
  k.run();
  EXPECT_FLOAT_EQ(1 / k.w.at(32, 32), 2);
  EXPECT_FLOAT_EQ(1 / k.w.at(44, 32), 1.5F);
}

TEST(Key, unknown_depth_far_from_people_is_nobody) {
  Keyed k;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) k.w.at(x, y) = 0;
  k.paint(0, 0, 64, 64, kShirt);
  k.run();
  EXPECT_EQ(k.people(), 0);
}

TEST(Key, speckles_are_dropped) {
  Keyed k;  // a ToF pixel spans two view pixels: six of them are 24 pixels
  k.person(30, 30, 34, 34);
  k.paint(30, 30, 34, 34, kShirt);
  k.run();
  EXPECT_EQ(k.people(), 0);
}

TEST(Key, points_outside_the_capture_box_are_cropped) {
  Keyed k;
  k.setup.capture_box = {glm::dvec3(-10, -10, 2.5), glm::dvec3(10, 10, 10)};
  k.person(8, 16, 28, 48, 2);
  k.person(36, 16, 56, 48, 3);
  k.run(false);
  EXPECT_FALSE(k.is_person(18, 32));
  EXPECT_TRUE(k.is_person(46, 32));
}

TEST(Key, where_the_background_has_no_depth_colour_keys) {
  Keyed k;
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 64; ++x) k.depth.at(x, y) = 0;
  k.person(20, 16, 48, 48);
  k.paint(20, 16, 48, 48, kShirt);
  k.run();
  EXPECT_TRUE(k.is_person(36, 32));
  EXPECT_FALSE(k.is_person(56, 32));
}

TEST(Key, who_stands_before_a_mirror_in_the_colour_of_the_wall_is_kept_by_depth) {
  Keyed k;
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 64; ++x) k.depth.at(x, y) = 0, k.w.at(x, y) = 0;
  k.person(16, 16, 56, 48);
  k.person(56, 0, 64, 64, 6);  // what the mirror shows lies behind the wall
  k.run();
  for (int x = 20; x < 53; ++x) EXPECT_TRUE(k.is_person(x, 32)) << x;
  for (int x = 58; x < 64; ++x) EXPECT_FALSE(k.is_person(x, 32)) << x;
}

TEST(Key, who_is_seen_in_a_mirror_is_nobody) {
  Keyed k;
  for (int y = 16; y < 48; ++y)
    for (int x = 16; x < 48; ++x) k.depth.at(x, y) = 0;
  k.person(24, 20, 40, 44, 6);  // farther than the wall around
  k.paint(24, 20, 40, 44, kShirt);
  k.run();
  EXPECT_EQ(k.people(), 0);
}

TEST(Key, the_share_of_a_pixel_is_that_of_its_colour_between_both_on_a_striped_wall) {
  Keyed k;
  const Rgbf stripe{0.1F, 0.4F, 0.1F};
  const auto half = [](Rgbf a, Rgbf b) {
    return Rgbf{(a.r + b.r) / 2, (a.g + b.g) / 2, (a.b + b.b) / 2};
  };
  k.person(16, 0, 40, 64);
  for (int y = 0; y < 64; ++y) {
    const Rgbf wall = y / 4 % 2 == 0 ? kWall : stripe;
    for (int x = 0; x < 64; ++x) k.color.at(x, y) = wall;
    k.paint(0, y, 64, y + 1, wall);
    k.paint(40, y, 41, y + 1, half(wall, kShirt));
  }
  k.paint(16, 0, 40, 64, kShirt);
  k.run();
  for (const int y : {29, 33}) {
    EXPECT_NEAR(k.matte.at(40, y) / 255.0, 0.5, 0.1) << y;
    EXPECT_GT(k.matte.at(38, y), 240) << y;
    EXPECT_LT(k.matte.at(42, y), 15) << y;
  }
}

TEST(Key, what_is_brighter_than_measured_background_is_no_shadow) {
  for (const auto& [light, is_person] : {std::pair(0.9F, true), std::pair(0.25F, false)}) {
    Keyed k;
    const Rgbf shirt{light, light, light};
    k.person(16, 16, 48, 40);
    k.paint(16, 16, 48, 46, shirt);  // the feet are nearer to the wall than its noise
    k.run();
    EXPECT_EQ(k.is_person(32, 44), is_person) << light;
    EXPECT_FALSE(k.is_person(32, 52)) << light;
  }
}

TEST(Key, a_shirt_like_the_wall_beside_dark_trousers_is_compared_with_the_shirt) {
  Keyed k;
  k.person(8, 0, 48, 64);
  k.paint(8, 0, 48, 32, {0.56F, 0.5F, 0.46F});
  k.paint(8, 32, 48, 64, {0.02F, 0.02F, 0.05F});
  for (int y = 24; y < 32; ++y)
    for (int x = 8; x < 16; ++x) k.w.at(x, y) = 0;  // the mean around is half shirt, half trousers
  k.run();
  for (int y = 25; y < 31; ++y)
    for (int x = 9; x < 15; ++x) EXPECT_TRUE(k.is_person(x, y)) << x << "," << y;
  EXPECT_FALSE(k.is_person(5, 28));
}

/// A sole on the rug: its depth is the rug's within the noise, and it is darker.
TEST(Key, what_no_shade_of_the_background_explains_outweighs_its_measured_depth) {
  const Rgbf rug{0.4F, 0.05F, 0.05F}, sole{0.12F, 0.12F, 0.12F};
  for (const auto& [below, is_person] :
       {std::pair(sole, true), std::pair(Rgbf{0.16F, 0.02F, 0.02F}, false)}) {
    Keyed k;
    k.setup.key.refine = false;
    k.color.fill(rug);
    k.paint(0, 0, 64, 64, rug);
    k.person(16, 16, 48, 40);
    k.paint(16, 16, 48, 40, sole);
    k.paint(16, 40, 48, 46, below);
    k.run();
    EXPECT_EQ(k.is_person(32, 43), is_person) << below.g;
    EXPECT_FALSE(k.is_person(32, 52)) << below.g;
  }
}

/// The depth camera closes the gap between two legs.
TEST(Key, a_gap_between_legs_in_the_colour_of_the_wall_is_no_person) {
  Keyed k;
  k.setup.key.refine = false;
  k.person(10, 0, 56, 64);
  k.paint(10, 0, 56, 64, {0.03F, 0.04F, 0.12F});
  k.paint(29, 20, 34, 44, kWall);
  for (const int y : {8, 9, 52, 53}) k.w.at(30, y) = k.w.at(31, y) = 0;  // votes decide here
  k.run();
  EXPECT_FALSE(k.is_person(31, 22));
  EXPECT_FALSE(k.is_person(31, 42));
}

/// A person stands before a mirror, behind a lamp that stands beside it.
TEST(Key, a_person_before_a_mirror_is_no_reflection_for_something_nearer_beside_it) {
  Keyed k;
  for (int y = 0; y < 64; ++y) {
    for (int x = 24; x < 64; ++x) k.depth.at(x, y) = 0, k.w.at(x, y) = 0;
    for (int x = 0; x < 24; ++x)
      k.depth.at(x, y) = y < 40 ? 1 : 4, k.w.at(x, y) = y < 40 ? 1 : 0.25F;
  }
  for (int y = 0; y < 4; ++y)
    for (int x = 24; x < 64; ++x) k.depth.at(x, y) = 4, k.w.at(x, y) = 0.25F;
  k.person(32, 12, 56, 52, 2);
  k.paint(32, 12, 56, 52, kShirt);
  k.run();
  for (const int y : {20, 30, 45})
    for (const int x : {38, 44, 50}) EXPECT_TRUE(k.is_person(x, y)) << x << "," << y;
}

/// Some pixels of a dark head in a mirror are measured too near.
TEST(Key, a_few_near_pixels_beside_what_a_mirror_shows_are_nobody) {
  for (const bool mirrored : {true, false}) {
    Keyed k;
    for (int y = 8; y < 56; ++y)
      for (int x = 8; x < 56; ++x) k.depth.at(x, y) = 0, k.w.at(x, y) = 0;
    k.person(28, 20, 35, 26);
    k.paint(24, 18, 40, 34, kShirt);
    if (mirrored) k.person(24, 26, 40, 52, 6);
    k.run();
    EXPECT_EQ(k.people() == 0, mirrored) << k.people();
  }
}

/// A mirror beside a person shows the person's sleeve, of which only part has depth.
TEST(Key, what_is_unknown_beside_what_a_mirror_shows_is_nobody) {
  const Rgbf coat{0.18F, 0.18F, 0.18F};
  for (const bool mirrored : {true, false}) {
    Keyed k;
    for (int y = 0; y < 64; ++y)
      for (int x = 28; x < 64; ++x) k.depth.at(x, y) = 0, k.w.at(x, y) = 0;
    k.person(8, 8, 28, 56);
    k.paint(8, 8, 28, 56, coat);
    k.paint(32, 24, 48, 40, coat);
    if (mirrored) k.person(40, 28, 44, 36, 6);
    k.run();
    EXPECT_TRUE(k.is_person(20, 32));
    EXPECT_EQ(k.is_person(36, 32), !mirrored);
  }
}

/// The depth camera lags: it shows walking people where they were before.
TEST(Key, a_strip_of_the_room_under_peoples_depth_is_no_colour_of_people) {
  Keyed k;
  k.person(8, 0, 44, 64);
  k.paint(8, 0, 36, 64, kShirt);
  k.run();
  for (int y = 8; y < 56; ++y) {
    EXPECT_TRUE(k.is_person(34, y)) << y;
    for (int x = 38; x < 64; ++x) EXPECT_FALSE(k.is_person(x, y)) << x << "," << y;
  }
}

/// The wall beside who walks is darker than it was learned, by more than a shadow of colour votes.
/// A striped shirt before the wall and a warm strip without depth beside it. The hue of the wall
/// around varies by `hue` from block to block.
Keyed warm_strip(float hue) {
  const auto warm = [](float by) { return Rgbf{kWall.r + by, kWall.g, kWall.b - by}; };
  Keyed k;
  k.person(16, 0, 32, 64);
  for (int x = 16; x < 32; x += 4) k.paint(x, 0, x + 4, 64, warm(x % 8 == 0 ? 0.15F : -0.15F));
  k.paint(32, 0, 40, 64, warm(0.06F));
  for (int y = 0; y < 64; ++y)
    for (int x = 32; x < 40; ++x) k.w.at(x, y) = 0;
  for (int x = 40; x < 64; x += 8) k.paint(x, 0, x + 8, 64, warm(x % 16 == 0 ? hue : -hue));
  k.run();
  return k;
}

TEST(Key, a_hue_that_the_room_around_does_not_have_is_a_person) {
  const Keyed steady = warm_strip(0), varied = warm_strip(0.06F);
  for (int y = 8; y < 56; ++y) {
    EXPECT_TRUE(steady.is_person(36, y)) << y;
    EXPECT_FALSE(varied.is_person(36, y)) << y;
  }
}

TEST(Key, a_strip_of_the_room_in_the_light_that_the_room_around_has_now_is_nobody) {
  for (const auto& [light, is_person] :
       {std::pair(Rgbf{0.32F, 0.34F, 0.37F}, false), std::pair(Rgbf{0.33F, 0.22F, 0.12F}, true)}) {
    Keyed k;
    k.person(8, 0, 44, 64);
    k.paint(36, 0, 64, 64, {0.32F, 0.34F, 0.37F});
    k.paint(8, 0, 36, 64, kShirt);
    k.paint(36, 0, 48, 64, light);
    k.run();
    for (int y = 8; y < 56; ++y) {
      EXPECT_TRUE(k.is_person(34, y)) << y;
      EXPECT_EQ(k.is_person(39, y), is_person) << light.r << "," << y;
      EXPECT_FALSE(k.is_person(52, y)) << y;
    }
  }
}

TEST(KeyLimit, is_the_nearest_background_around_less_the_threshold) {
  render::BackgroundView background;
  const auto depth = make_image<float>({9, 1}, [](int x, int) {
    return x < 3 ? 2.0F : x < 8 ? 4.0F : 0.0F;
  });
  background.depth_m = depth;
  const auto limit = render::key_limit(background, {0.1F, 0, true}, {0, 0, 0}, 2);
  EXPECT_NEAR(1 / limit.w.at(4, 0), 1.9F, 1e-5F) << "two pixels from the near wall";
  EXPECT_NEAR(1 / limit.w.at(5, 0), 3.9F, 1e-5F);
  EXPECT_NEAR(limit.w.at(8, 0), -1 / 3.9F, 1e-5F) << "not learned: that around";
  EXPECT_EQ(limit.behind_w.at(4, 0), 0);
}

TEST(KeyLimit, of_a_hole_is_the_nearest_of_what_lies_beside_it) {
  render::BackgroundView background;
  const auto depth = make_image<float>({9, 9}, [](int x, int y) {
    if (x == 4) return 0.0F;
    return x > 4 ? 2.0F : y == 0 ? 1.0F : 4.0F;
  });
  background.depth_m = depth;
  const auto limit = render::key_limit(background, {0.1F, 0, true}, {0, 0, 0}, 0);
  EXPECT_NEAR(limit.w.at(4, 4), -1 / 1.9F, 1e-5F);
  EXPECT_NEAR(limit.w.at(4, 0), -1 / 0.9F, 1e-5F);
  EXPECT_NEAR(limit.behind_w.at(4, 4), 0.93F / 3.9F, 1e-5F) << "behind the second nearest";
  EXPECT_NEAR(limit.behind_w.at(4, 0), 0.93F / 1.9F, 1e-5F);
  const Image<float> nothing({9, 9});
  background.depth_m = nothing;
  EXPECT_TRUE(std::isinf(render::key_limit(background, {0.1F, 0, true}, {0, 0, 0}, 0).w.at(4, 4)));
}

TEST(Normals, of_a_tilted_plane_are_exact_and_face_the_camera) {
  const geometry::Pinhole view = ideal_camera({64, 64}, 64).pinhole;
  const Eigen::Vector3d n = Eigen::Vector3d(0.3, -0.5, -1).normalized();
  const auto depth = make_image<float>({64, 64}, [&](int x, int y) {
    const Eigen::Vector2d r = view.unproject({x, y});
    return static_cast<float>(-3 / n.dot(Eigen::Vector3d(r.x(), r.y(), 1)));
  });
  const auto normals = render::normals(depth, view, 4);
  const render::PackedNormal p = normals.at(32, 32);
  EXPECT_NEAR(p.x / 127.0, n.x(), 0.01);
  EXPECT_NEAR(p.y / 127.0, n.y(), 0.01);
  EXPECT_NEAR(p.z / 127.0, n.z(), 0.01);
}

}  // namespace
}  // namespace mixrig::test
