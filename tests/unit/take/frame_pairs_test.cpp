// SPDX-License-Identifier: Apache-2.0
// Which pictures make a frame: streams of other rates, lists in other units, times that cannot be.
#include "host/capture/take/frame_pairs.h"

#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::take {
namespace {

StreamInfo stream(int count, double rate_hz, double delay_s = 0) {
  return {"p/%d.png", 1, count, rate_hz, delay_s};
}

/// Picture k of 12.5 Hz is of the time of picture 2 k of 25 Hz.
TEST(FramePairs, StreamsOfOtherRatesPairByTime) {
  const auto pairs = pair_numbered(stream(8, 12.5), stream(16, 25), false);
  ASSERT_EQ(pairs.size(), 8U);
  for (int k = 0; k < 8; ++k) {
    EXPECT_EQ(pairs[static_cast<std::size_t>(k)].color, k);
    EXPECT_EQ(pairs[static_cast<std::size_t>(k)].depth, 2 * k);
    EXPECT_NEAR(pairs[static_cast<std::size_t>(k)].depth_after_s, 0, 1e-12);
  }
}

/// 30 Hz and 25 Hz: five depth pictures fall on six of colour; the nearest is at most 1/60 s away.
TEST(FramePairs, TheSlowerStreamGetsTheNearestOfTheFaster) {
  const auto pairs = pair_numbered(stream(60, 30), stream(50, 25), false);
  ASSERT_EQ(pairs.size(), 50U);
  int last = -1;
  for (const PicturePair& pair : pairs) {
    const double apart_s = pair.depth / 25.0 - pair.color / 30.0;
    EXPECT_NEAR(pair.depth_after_s, apart_s, 1e-12);
    EXPECT_LE(std::abs(apart_s), 0.5 / 30 + 1e-5);
    EXPECT_GT(pair.color, last);
    last = pair.color;
  }
  EXPECT_EQ(pairs.back().color, 59) << "1.96 s is 58.8 pictures of 1/30 s";
}

/// With depth 21 ms after colour, depth k is of 0.04 k + 0.021 s: nearest to colour c, of 0.08 c s,
/// is depth 2 c - 1, which the first picture lacks.
TEST(FramePairs, ADelayCountsAndWhatHasNoPartnerIsLeftOut) {
  const auto pairs = pair_numbered(stream(4, 12.5), stream(8, 25, 0.021), false);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[0].color, 1);
  EXPECT_EQ(pairs[0].depth, 1);
  EXPECT_NEAR(pairs[0].depth_after_s, 0.04 + 0.021 - 0.08, 1e-12);
}

TEST(FramePairs, EqualOrUnknownRatesAndRecordingsPairByNumber) {
  for (const auto& [color, depth, by_number] :
       {std::tuple(stream(3, 25), stream(4, 25, 0.01), false),
        std::tuple(stream(3, 0), stream(4, 25, 0.01), false),
        std::tuple(stream(3, 12.5), stream(4, 25, 0.01), true)})
    EXPECT_EQ(pair_numbered(color, depth, by_number),
              (std::vector<PicturePair>{{0, 0, 0.01}, {1, 1, 0.01}, {2, 2, 0.01}}));
}

std::vector<StampedFile> list_of(std::initializer_list<double> times) {
  std::vector<StampedFile> files;
  for (const double time : times) files.push_back({time, std::to_string(files.size()) + ".png"});
  return files;
}

TEST(FramePairs, OddStampsAreNamed) {
  EXPECT_TRUE(odd_stamps(list_of({1, 1.04, 1.08}), "rgb.txt").empty());
  const auto lines = odd_stamps(list_of({1, 1.04, 1.02, 1.08}), "rgb.txt");
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("the time of '2.png' is before that of '1.png'"), std::string::npos);
  for (const auto& [step, unit] :
       {std::pair(40.0, "milliseconds"), std::pair(40000.0, "microseconds"),
        std::pair(4e7, "nanoseconds")}) {
    const auto odd = odd_stamps(list_of({0, step, 2 * step}), "rgb.txt");
    ASSERT_EQ(odd.size(), 1U);
    EXPECT_NE(odd[0].find(unit), std::string::npos) << odd[0];
  }
}

class StampedLists : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("take.toml",
                  std::string("format = 1\n[color]\npath = \"rgb.txt\"\n[depth]\npath = "
                              "\"depth.txt\"\n[target]\n") +
                      kCamera + "[tof]\n" + kCamera +
                      "[target_from_tof]\nrotation_xyzw = [0, 0, 0, 1]\ntranslation_m "
                      "= [0, 0, 0]\n");
  }
  Result<TakeReader> open(const std::string& color, const std::string& depth) {
    folder_.write("rgb.txt", color);
    folder_.write("depth.txt", depth);
    return TakeReader::open(folder_ / "take.toml");
  }
  static constexpr const char* kCamera =
      "size_px = [64, 48]\nfx = 60\nfy = 60\ncx = 31.5\ncy = 23.5\n";
  test::TemporaryFolder folder_;
};

TEST_F(StampedLists, TimesSince1970AreReadInTheirUnit) {
  struct StampedRow {
    const char *color, *depth;
  };
  for (const StampedRow& row :
       {StampedRow{"1548266469540000000 a\n1548266469580000000 b\n",
                   "1548266469551000000 A\n1548266469591000000 B\n"},
        StampedRow{"1548266469540 a\n1548266469580 b\n", "1548266469551 A\n1548266469591 B\n"},
        StampedRow{"1548266469540000 a\n1548266469580000 b\n",
                   "1548266469.551 A\n1548266469.591 B\n"}}) {
    const auto reader = open(row.color, row.depth);
    ASSERT_TRUE(reader) << reader.error().context;
    EXPECT_EQ(reader->info().frames, 2) << row.color;
  }
}

TEST_F(StampedLists, ListsThatDoNotPairSayHowFarTheyAreApart) {
  EXPECT_TRUE(test::refused(open("0 a\n40000000 b\n", "11000000 A\n51000000 B\n"),
                            {"rgb.txt: the nearest depth picture is 1.1e+07 s away",
                             "times are seconds (these look like nanoseconds)"},
                            ErrorCode::kFormat));
  EXPECT_TRUE(test::refused(open("0 a\n40 b\n", "11 A\n51 B\n"), {"11 s away", "milliseconds"},
                            ErrorCode::kFormat));
  EXPECT_TRUE(test::refused(open("1.00 a\n1.04 b\n", "7.5 A\n7.54 B\n"),
                            {"6.46 s away", "on one clock"}, ErrorCode::kFormat));
  EXPECT_TRUE(test::refused(open("1.00 a\n", "# none\n"), {"list of depth has no picture"},
                            ErrorCode::kFormat));
}

}  // namespace
}  // namespace mixrig::take
