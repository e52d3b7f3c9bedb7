// SPDX-License-Identifier: Apache-2.0
// Letters and marks, pixel by pixel.
#include "host/output/viewfinder/marks.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "host/output/viewfinder/font.h"

namespace mixrig::viewfinder {
namespace {

constexpr Rgbx8 kGrey{100, 100, 100, 255};

bool same(Rgbx8 a, Rgbx8 b) { return a.r == b.r && a.g == b.g && a.b == b.b; }

std::string art(char letter) {
  std::string out;
  for (int y = 0; y < kGlyphHeight_px; ++y) {
    for (int x = 0; x < kGlyphWidth_px; ++x) out += glyph_pixel(letter, x, y) ? '#' : '.';
    out += '\n';
  }
  return out;
}

TEST(Font, LettersLookLikeThemselves) {
  EXPECT_EQ(art('A'), ".###.\n#...#\n#...#\n#...#\n#####\n#...#\n#...#\n");
  EXPECT_EQ(art('F'), "#####\n#....\n#....\n####.\n#....\n#....\n#....\n");
  EXPECT_EQ(art('4'), "...#.\n..##.\n.#.#.\n#..#.\n#####\n...#.\n...#.\n");
  EXPECT_EQ(art('.'), ".....\n.....\n.....\n.....\n.....\n.##..\n.##..\n");
}

TEST(Font, EveryLetterIsItsOwnAndOthersAreAQuestionMark) {
  std::set<std::string> all;
  for (char letter = ' '; letter <= '~'; ++letter) all.insert(art(letter));
  EXPECT_EQ(all.size(), 95U);
  EXPECT_EQ(art('\n'), art('?'));
  EXPECT_EQ(art(static_cast<char>(0xe4)), art('?'));
}

TEST(Font, TextIsAsWideAsItSaysAndIsCutOffAtTheBorders) {
  EXPECT_EQ(text_size("FF", 2), (Size{22, 14}));
  Image<Rgbx8> picture({22, 14}, kGrey);
  draw_text(picture, 0, 0, "FF", 2, {255, 0, 0});
  for (int y = 0; y < 14; ++y)
    for (int x = 0; x < 22; ++x) {
      const bool ink = x % 12 < 10 && glyph_pixel('F', x % 12 / 2, y / 2);
      EXPECT_EQ(picture.at(x, y).g, ink ? 0 : 100) << x << ' ' << y;
    }
  picture.fill(kGrey);
  draw_text(picture, -7, -3, "FFFFFF", 2, {255, 0, 0});  // does not write outside
  draw_text(picture, 400, 400, "F", 2, {255, 0, 0});
  for (int y = 0; y < 14; ++y)
    for (int x = 0; x < 22; ++x) {
      const int across = (x + 7) % 12, down = y + 3;
      const bool ink = across < 10 && down < 14 && glyph_pixel('F', across / 2, down / 2);
      EXPECT_TRUE(same(picture.at(x, y), ink ? Rgbx8{255, 0, 0, 255} : kGrey)) << x << ' ' << y;
    }
}

TEST(Marks, ZebraStripesWhatIsSaturatedInAnyChannelAndNothingElse) {
  Image<Rgbx8> picture({24, 16}, kGrey);
  for (int y = 0; y < 16; ++y)
    for (int x = 8; x < 24; ++x)
      picture.at(x, y) = x < 16 ? Rgbx8{10, 250, 20, 255} : Rgbx8{249, 249, 249, 255};
  mark_exposure_and_focus(picture, true, false);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x) {
      const Rgbx8 was = x < 8    ? kGrey
                        : x < 16 ? Rgbx8{10, 250, 20, 255}
                                 : Rgbx8{249, 249, 249, 255};
      const bool black = x >= 8 && x < 16 && (x + y) % 8 < 4;
      EXPECT_TRUE(same(picture.at(x, y), black ? Rgbx8{} : was)) << x << ' ' << y;
    }
}

TEST(Marks, PeakingMarksAStepOfBrightnessOnceAndSparesASlope) {
  Image<Rgbx8> picture({32, 8}, kGrey);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 32; ++x) {
      const auto slope = static_cast<std::uint8_t>(std::min(255, 100 + 8 * x));
      picture.at(x, y) = x < 16 ? Rgbx8{slope, slope, slope, 255} : Rgbx8{20, 20, 20, 255};
    }
  mark_exposure_and_focus(picture, false, true);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 32; ++x) EXPECT_EQ(picture.at(x, y).g == 30, x == 15) << x << ' ' << y;
}

TEST(Marks, BothAreDecidedByThePictureAsItCame) {
  // The edge turns red, which is saturated; a saturated pixel beside it turns black, which is an
  // edge: neither makes the other.
  Image<Rgbx8> picture({16, 1}, Rgbx8{255, 255, 255, 255});
  for (int x = 0; x < 8; ++x) picture.at(x, 0) = kGrey;
  mark_exposure_and_focus(picture, true, true);
  for (int x = 0; x < 16; ++x) {
    const Rgbx8 expected = x < 7    ? kGrey
                           : x == 7 ? Rgbx8{255, 30, 30, 255}
                           : x < 12 ? Rgbx8{0, 0, 0, 255}
                                    : Rgbx8{255, 255, 255, 255};
    EXPECT_TRUE(same(picture.at(x, 0), expected)) << x;
  }
}

TEST(Marks, GuidesAreThirdsACrossAndTwoBorders) {
  Image<Rgbx8> picture({120, 90}, kGrey);
  draw_guides(picture);
  const auto marked = [&](int x, int y) { return picture.at(x, y).r != 100; };
  EXPECT_TRUE(same(picture.at(40, 5), Rgbx8{177, 177, 177, 255})) << "half white";
  for (const int x : {40, 80}) EXPECT_TRUE(marked(x, 2)) << x;
  for (const int y : {30, 60}) EXPECT_TRUE(marked(2, y)) << y;
  EXPECT_TRUE(marked(60, 45));
  EXPECT_TRUE(marked(6, 50) && marked(113, 50)) << "90 %";
  EXPECT_TRUE(marked(12, 50) && marked(107, 50)) << "80 %";
  for (const int x : {0, 5, 7, 11, 13, 30, 50, 90}) EXPECT_FALSE(marked(x, 50)) << x;
  Image<Rgbx8> tiny({7, 3}, kGrey);
  draw_guides(tiny);
  EXPECT_TRUE(same(tiny.at(3, 1), kGrey));
}

TEST(Marks, DarkenAndBorderStayInThePicture) {
  Image<Rgbx8> picture({10, 10}, kGrey);
  darken(picture, -5, 8, {8, 20});
  EXPECT_EQ(picture.at(2, 8).r, 50);
  EXPECT_EQ(picture.at(3, 8).r, 100);
  EXPECT_EQ(picture.at(2, 7).r, 100);
  draw_border(picture, 2, {1, 2, 3});
  EXPECT_EQ(picture.at(1, 5).b, 3);
  EXPECT_EQ(picture.at(8, 8).b, 3);
  EXPECT_EQ(picture.at(2, 5).b, 100);
}

TEST(Marks, APlaceholderHasNothingOfThePicture) {
  Image<Rgbx8> one({40, 30}, kGrey), other({40, 30}, Rgbx8{1, 200, 9, 255});
  draw_placeholder(one), draw_placeholder(other);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) EXPECT_TRUE(same(one.at(x, y), other.at(x, y)));
  EXPECT_TRUE(same(one.at(0, 0), one.at(39, 29))) << "a cross";
  EXPECT_FALSE(same(one.at(0, 0), one.at(20, 2)));
}

}  // namespace
}  // namespace mixrig::viewfinder
