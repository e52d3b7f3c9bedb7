// SPDX-License-Identifier: Apache-2.0
// bracket.csv: rows that are read as they were written, and rows that are refused.
#include "host/capture/take/bracket_files.h"

#include <array>
#include <fstream>

#include <gtest/gtest.h>

#include "host/capture/take/growing_take.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/take/made_take.h"

namespace mixrig::take {
namespace {

TEST(BracketFiles, RowsAreReadAsTheyWereWritten) {
  const std::vector<BracketRow> rows{{4, 0.002, 0.008}, {4, 5e-4, 0.008}, {12, 0.032, 0.008}};
  const auto read = parse_bracket_table(bracket_text(rows), "bracket.csv");
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_EQ(*read, rows);
}

TEST(BracketFiles, EachBadRowIsOneLine) {
  for (const char* row : {"2,4,0.002,0.008", "1,0,0.002,0.008", "1,4,0,0.008", "1,4,nan,0.008",
                          "1,4,inf,0.008", "1,4,0.002,-1", "1,4,0.002,1e9", "1,4,0.002",
                          "1,4,0.002,0.008,1", "1,4,0.002,0.008\n2,3,0.002,0.008", "a,b,c,d"}) {
    EXPECT_TRUE(
        test::refused(parse_bracket_table(std::string(kBracketHeader) + row + "\n", "bracket.csv"),
                      {"bracket.csv:"}))
        << row;
  }
}

TEST(BracketFiles, ATakeThatIsContinuedKeepsThoseOfWholeViews) {
  const test::TemporaryFolder folder;
  const auto append = [&](int first, bool bracket) {
    auto take = GrowingTake::open(folder / "sweep", made_info());
    ASSERT_TRUE(take) << take.error().context;
    const std::array frames{made_frame(first), made_frame(first + 1)};
    std::vector<capture::BracketPlate> plates;
    if (bracket) plates.push_back({0.002, 0.008, made_frame(first + 7).plate});
    ASSERT_TRUE(take->append(frames, {0.1 * first, 0}, plates));
  };
  append(1, true);
  // A row left by a view that was interrupted before the manifest was written.
  std::ofstream(folder / "sweep" / kBracketTable, std::ios::app) << "2,4,0.0005,0.008\n";
  append(3, false);
  append(5, true);
  const auto rows = read_bracket_table(folder / "sweep");
  ASSERT_TRUE(rows) << rows.error().context;
  EXPECT_EQ(*rows, (std::vector<BracketRow>{{2, 0.002, 0.008}, {6, 0.002, 0.008}}));
  Image<Rgb8> plate;
  ASSERT_TRUE(read_bracket_plate(folder / "sweep", 2, plate));
  EXPECT_EQ(plate.at(0, 0), made_frame(12).plate.at(0, 0));
  EXPECT_FALSE(read_bracket_plate(folder / "sweep", 3, plate));
}

TEST(BracketFiles, ATakeWithoutThemHasNone) {
  const test::TemporaryFolder folder;
  const auto rows = read_bracket_table(folder.path());
  ASSERT_TRUE(rows);
  EXPECT_TRUE(rows->empty());
}

}  // namespace
}  // namespace mixrig::take
