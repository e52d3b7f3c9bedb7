// SPDX-License-Identifier: Apache-2.0
// What somebody types who does not know the command: each line says what is wrong and what to do.
#include <gtest/gtest.h>

#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

struct Typed {
  std::string words;
  int status;
  std::vector<std::string> contains;  ///< each must be in the error line
};

void PrintTo(const Typed& typed, std::ostream* out) { *out << typed.words; }

/// folder/ is empty, full/ holds a file of somebody, notes.txt is text, bytes.bin is noise.
void add_strange_files(const TinyTake& take) {
  fs::create_directories(take.path("folder"));
  fs::create_directories(take.path("full"));
  take.text("full/mine.txt", "x");
  take.text("notes.txt", "hello");
  take.text("bytes.bin", std::string("\x93\x01\xff\xfe", 4));
  take.text("empty.toml", "");
}

class Newcomer : public ::testing::TestWithParam<Typed> {};

TEST_P(Newcomer, IsToldWhatToDoInOneLine) {
  const TinyTake take;
  add_strange_files(take);
  const auto before = take.contents();
  const Outcome outcome = take.mixrig(GetParam().words);
  EXPECT_EQ(outcome.status, GetParam().status) << outcome.err;
  EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
  for (const std::string& word : GetParam().contains)
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " is not in: " << outcome.err;
  EXPECT_EQ(take.contents(), before);
}

// Files and folders of the wrong kind, or none.
INSTANTIATE_TEST_SUITE_P(
    Files, Newcomer,
    ::testing::Values(
        Typed{"run scene.toml --source folder", 2, {"folder/take.toml", "the folder of a take"}},
        Typed{"run scene.toml --source take/color/000001.png", 2, {"is not a source", "take:DIR"}},
        Typed{"run scene.toml --source /dev/video0", 2, {"is not a source", "rig[:RIG.TOML]"}},
        Typed{"run scene.toml --source rig", 2, {"rig.toml", "mixrig rig init"}},
        Typed{"run notes.txt --source take", 2, {"notes.txt:1", "not valid TOML"}},
        Typed{"run folder --source take", 2, {"'folder' is a folder", "scene.toml"}},
        Typed{"run scene.toml --source take --calibration folder", 2, {"folder", "name a file"}},
        Typed{"run scene.toml --source take --calibration scene.toml", 2, {"of a scene"}},
        Typed{"run scene.toml --source take --out notes.txt/out", 1, {"notes.txt/out"}},
        Typed{"run scene.toml --source take --record-to notes.txt --page 127.0.0.1:0",
              2,
              {"--record-to", "notes.txt", "is a file"}},
        Typed{"info folder", 2, {"folder/take.toml", "the folder of a take"}},
        Typed{"info nowhere", 2, {"nowhere", "check the path"}},
        Typed{"info bytes.bin", 2, {"bytes.bin:1", "not valid TOML"}},
        Typed{"info take/color/000001.png", 2, {"a PNG picture"}},
        Typed{"record out", 2, {"rig.toml", "mixrig rig init"}},
        Typed{"record out --rig folder", 2, {"folder", "name a file"}},
        Typed{"diag --rig empty.toml", 2, {"empty.toml:1", "format"}},
        Typed{"scan --take notes.txt bg", 2, {"notes.txt:1", "not valid TOML"}},
        Typed{"track --model take --take take out.txt", 2, {"take/manifest.toml", "mixrig scan"}},
        Typed{"lights --model folder", 2, {"folder/manifest.toml", "mixrig scan"}},
        Typed{"align take take", 2, {"take", "no such trajectory file"}},
        Typed{"align notes.txt notes.txt", 2, {"notes.txt:1", "t x y z"}},
        Typed{"import bytes.bin out", 2, {"bytes.bin", "of no kind that is known"}},
        Typed{"flash folder --port /dev/ttyUSB9", 2, {"is a folder", "name a .bin"}},
        Typed{"flash notes.txt --port /dev/ttyUSB9", 2, {"no mixrig trigger image", "nothing"}},
        Typed{"new full", 2, {"'full' holds other files", "name a new folder"}},
        Typed{"plan scene.toml full --source take", 2, {"'full' holds other files"}}));

// Numbers, units, and words that are swapped or misspelt.
INSTANTIATE_TEST_SUITE_P(
    Words, Newcomer,
    ::testing::Values(
        Typed{"run take scene.toml", 2, {"'scene.toml' is one argument too many"}},
        Typed{
            "run scene.toml --source take --threads two", 2, {"--threads: two is no whole number"}},
        Typed{"run scene.toml --source take --frames 4-3", 2, {"--frames", "FIRST-LAST"}},
        Typed{"run scene.toml --source take --frames 3-99999999999999999999", 2, {"FIRST-LAST"}},
        Typed{"run scene.toml --source take --size 160*128", 2, {"--size", "WIDTHxHEIGHT"}},
        Typed{"run scene.toml --source take --page 99999", 2, {"99999", "ADDRESS:PORT"}},
        Typed{"run scene.toml --source take --stream rtmp://host/live", 2, {"srt://HOST:PORT"}},
        Typed{"run scene.toml --source take --format mp4", 2, {"mp4", "png,video,none"}},
        Typed{"explain scene.toml --source take --frames 1e9", 2, {"1e9 is no whole number"}},
        Typed{"place scene.toml --source take --pixel 16x12", 2, {"--pixel", "320,240"}},
        Typed{"place scene.toml --source take --pixel 16,12 --turn 90deg",
              2,
              {"--turn: 90deg is no number"}},
        Typed{"record out --duration 10min", 2, {"10min is", "number"}},
        Typed{"record out --duration -5", 2, {"-5 is no number from 0 to 86400"}},
        Typed{"scan --take take --field 270 bg", 2, {"--field", "WIDTHxHEIGHT"}},
        Typed{"rig ini", 2, {"did you mean init?"}},
        Typed{"trigger set 99 --rate 30", 2, {"trigger set", "--help"}},
        Typed{"bench --suite nothing", 2, {"nothing", "soak"}}));

#ifdef MIXRIG_EXTRA_STUDIO
INSTANTIATE_TEST_SUITE_P(
    Studio, Newcomer,
    ::testing::Values(Typed{"studio out --seed x", 2, {"--seed: x is no whole number"}},
                      Typed{
                          "studio out --frames 99999999999", 2, {"no whole number, or too large"}},
                      Typed{"studio out --scenario wlak", 2, {"wlak", "walk"}},
                      Typed{"studio out --focus-m 2m", 2, {"--focus-m: 2m is no number"}},
                      Typed{"studio out --eye 1,2", 2, {"three numbers"}}));
#endif

TEST(NewcomerNames, OfFoldersMayHaveSpacesUmlautsAndADash) {
  const TinyTake take;
  fs::rename(take.path("take"), take.path("mein tägliches 1"));
  const Outcome outcome = take.mixrig(
      "run scene.toml --source 'mein tägliches 1' --out '-aus gabe ü' --backend cpu --format none");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("done: wrote -aus gabe ü"), std::string::npos) << outcome.out;
  EXPECT_TRUE(fs::exists(take.path("-aus gabe ü/report.json")));
}

TEST(NewcomerEnd, SaysWhichVideoWasWritten) {
  const TinyTake take;
  const Outcome outcome =
      take.mixrig("run scene.toml --source take --stream out.mkv --backend cpu");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("done: wrote out.mkv, "), std::string::npos) << outcome.out;
}

TEST(NewcomerEnd, IsNotDoneWhereTheReportCannotBeWritten) {
  const TinyTake take;
  const Outcome outcome =
      take.mixrig("run scene.toml --source take --out out --json /dev/full --backend cpu");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("'/dev/full'"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.out.find("done"), std::string::npos) << outcome.out;
}

TEST(NewcomerScan, IsToldThatACameraThatStandsStillShowsOneView) {
  const TinyTake take;
  take.text("take/poses.txt",
            "0.00 0 0 0 0 0 0 1\n0.04 0 0 0 0 0 0 1\n0.08 0 0 0 0 0 0 1\n"
            "0.12 0 0 0 0 0 0 1\n");
  take.edit("take/take.toml", "[target]", "[pose]\nfile = \"poses.txt\"\n[target]");
  const Outcome outcome = take.mixrig("scan --take take room");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("stands still"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("--frames FIRST-LAST"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace mixrig::test
