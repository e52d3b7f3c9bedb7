// SPDX-License-Identifier: Apache-2.0
// The command line: help, version, unknown words, and a run that succeeds.
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tests/unit/tools/tiny_take.h"

namespace mixrig::test {
namespace {

constexpr const char* kPoseOfTake =
    "\n[pose]\nworld_from_target = { rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], "
    "[0.0, -1.0, 0.0]], translation_m = [1.0, 0.0, 1.5] }\n";

TEST(CommandLine, EveryCommandHasHelp) {
  const TinyTake take;
  for (const char* words :
       {"--help", "run --help", "scan --help", "explain --help", "info --help"}) {
    const Outcome outcome = take.mixrig(words);
    EXPECT_EQ(outcome.status, 0) << words;
    EXPECT_NE(outcome.out.find("--help"), std::string::npos) << words;
    EXPECT_EQ(outcome.err, "") << words;
  }
}

TEST(CommandLine, VersionIsOneLine) {
  const Outcome outcome = TinyTake().mixrig("--version");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_EQ(outcome.out.rfind("mixrig ", 0), 0U);
}

TEST(CommandLine, WrongWordsAreOneLineAndStatusTwo) {
  const TinyTake take;
  for (const char* words :
       {"", "composit", "run", "run scene.toml --source take:take --out out --bakend cpu",
        "run scene.toml --source take:take --out out --backend vulkan", "info", "info a b",
        "run scene.toml --source take:take --out out --threads many"}) {
    const Outcome outcome = take.mixrig(words);
    EXPECT_EQ(outcome.status, 2) << words << ": " << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << words << ": " << outcome.err;
  }
  EXPECT_NE(take.mixrig("composit").err.find("composit"), std::string::npos);
  EXPECT_NE(take.mixrig("run").err.find("SCENE"), std::string::npos);
}

TEST(CommandLine, RunWritesItsFolderAndReportAndIsSilentOnStderr) {
  const TinyTake take;
  const std::string words =
      "run scene.toml --source take:take --out out --backend cpu --json report.json";
  for (int times = 0; times < 2; ++times) {  // the second replaces the first
    const Outcome outcome = take.mixrig(words);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_NE(outcome.out.find("fps"), std::string::npos);
  }
  for (const char* name : {"out/report.json", "out/contact_sheet.png", "out/composite/take.toml"})
    EXPECT_TRUE(fs::exists(take.path(name))) << name;
  auto told = nlohmann::json::parse(take.text_of("report.json"));
  EXPECT_EQ(told["out"], "out");
  for (const char* key : {"out", "next", "notes"}) told.erase(key);
  EXPECT_EQ(told, nlohmann::json::parse(take.text_of("out/report.json")));
}

TEST(CommandLine, TheLastLineSaysWhatWasWrittenAndWhatIsNext) {
  struct LastLine {
    const char *words, *wrote, *next = "";
  };
  std::vector<LastLine> rows{
      {"run scene.toml --source take --out out --backend cpu", "out", "look at out/contact_sheet"},
      {"scan --take take --frames 1-3 bg", "bg", "background.model = \"bg\""},
      {"scan --take take:take room", "room", "mixrig info room"},
      {"info room --picture plan.png", "plan.png"},
      {"track --mocap m.csv --up z path.tum", "path.tum"},
  };
#ifdef MIXRIG_EXTRA_STUDIO
  rows.push_back({"studio s --frames 3 --size 64x48", "s", "mixrig run s/scene.toml"});
#endif
#ifdef MIXRIG_EXTRA_PEOPLE
  rows.push_back({"plan scene.toml --source take p", "p", "look at p/plan.png"});
#endif
  const TinyTake take;
  take.text("m.csv", "frame,t_s,id,x_m,y_m,z_m,qx,qy,qz,qw\n1,0,1,0,0,0,0,0,0,1\n");
  take.text("take/take.toml", take.text_of("take/take.toml") + kPoseOfTake);
  for (const LastLine& row : rows) {
    const Outcome outcome = take.mixrig(row.words);
    ASSERT_EQ(outcome.status, 0) << row.words << ": " << outcome.err;
    const std::string line =
        outcome.out.substr(outcome.out.rfind('\n', outcome.out.size() - 2) + 1);
    EXPECT_EQ(line.rfind(std::string("done: wrote ") + row.wrote + ", ", 0), 0U) << line;
    EXPECT_NE(line.find(row.next), std::string::npos) << line;
    EXPECT_TRUE(fs::exists(take.path(row.wrote))) << line;
  }
}

TEST(CommandLine, ARunNotesWhatItsSceneLacks) {
  const Outcome run = TinyTake().mixrig("run scene.toml --source take --backend cpu");
  EXPECT_NE(run.out.find("note: scene.toml: no [[object]]"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("nobody was keyed in any frame"), std::string::npos) << run.out;
}

/// The scene is a pipe that is written to only after the run has said what it opens.
TEST(CommandLine, APipedRunSaysItsFirstWordWhileItStillOpensTheScene) {
  const TinyTake take;
  fs::remove(take.path("scene.toml"));
  ASSERT_EQ(mkfifo(take.path("scene.toml").c_str(), 0600), 0);
  const std::string line = "cd " + take.path("").string() +
                           " && timeout 60 " MIXRIG_COMMAND
                           " run scene.toml --source take 2>&1 >/dev/null";
  FILE* const run = popen(line.c_str(), "r");
  ASSERT_NE(run, nullptr);
  char word[200] = {};
  EXPECT_NE(fgets(word, sizeof word, run), nullptr);
  EXPECT_STREQ(word, "opening the scene 0/1\n");
  if (word[0] != 0) take.text("scene.toml", "");
  pclose(run);
}

#ifdef MIXRIG_EXTRA_STUDIO
/// Its first picture is ray traced for longer than a word may take.
TEST(CommandLine, APipedRunSaysItsFirstWordBeforeAFirstFrameThatTakesLong) {
  const TinyTake take;
  FILE* const run = popen(
      ("cd " + take.path("").string() +
       " && exec " MIXRIG_COMMAND " run scene.toml --source studio:walk,7,kinect2,400,4096x3072"
       " 2>&1 >/dev/null & echo $!; wait")
          .c_str(),
      "r");
  ASSERT_NE(run, nullptr);
  char process[32] = {}, word[200] = {};
  ASSERT_NE(fgets(process, sizeof process, run), nullptr);
  EXPECT_NE(fgets(word, sizeof word, run), nullptr);
  const std::string first = word;
  EXPECT_TRUE(first == "first step 0/1\n" || first == "opening the scene 0/1\n") << first;
  ::kill(std::atoi(process), SIGKILL);
  pclose(run);
}
#endif

TEST(CommandLine, AnErrorIsJsonWhereTheReportWouldBe) {
  const TinyTake take;
  for (const char* words : {"info no --json -", "run --json=- --sorce x"}) {
    const Outcome outcome = take.mixrig(words);
    const auto json = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(json["exit_status"], outcome.status);
    EXPECT_EQ("mixrig: " + json["error"].get<std::string>() + "\n", outcome.err);
  }
}

TEST(CommandLine, RigInitWithoutDevicesWritesNothing) {
  for (const char* device : {"/dev/video0", "/dev/ttyACM0", "/dev/ttyUSB0", "/dev/bus/usb"})
    if (fs::exists(device)) GTEST_SKIP() << "this machine has " << device;
  const TinyTake take;
  const Outcome outcome = take.mixrig("rig init --no-network");
  EXPECT_EQ(outcome.status, 1);
  for (const char* word : {"looked for", "/dev/video", "/dev/ttyACM", "70-mixrig.rules"})
    EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(take.path("rig.toml")));
}

TEST(CommandLine, ScanGivesABackgroundThatRunTakes) {
  const TinyTake take;
  const Outcome scan = take.mixrig("scan --take take --frames 1-3 bg --backend cpu");
  ASSERT_EQ(scan.status, 0) << scan.err;
  EXPECT_NE(scan.out.find("100.0 %"), std::string::npos) << scan.out;
  EXPECT_NE(scan.out.find("\ndone: wrote bg, "), std::string::npos) << scan.out;
  EXPECT_NE(scan.out.find("background.model = \"bg\""), std::string::npos) << scan.out;
  take.edit("scene.toml", "learn = [1, 3]", "model = \"bg\"");
  const std::string words = "run scene.toml --source take:take --out out --backend cpu";
  EXPECT_EQ(take.mixrig(words).status, 0);
  const Outcome other_size = take.mixrig(words + " --size 16x12");
  EXPECT_EQ(other_size.status, 1);
  EXPECT_NE(other_size.err.find("scan it again"), std::string::npos) << other_size.err;
}

TEST(CommandLine, InfoDescribesAScannedRoom) {
  const TinyTake take;
  take.text("take/take.toml", take.text_of("take/take.toml") + kPoseOfTake);
  const Outcome scan = take.mixrig("scan --take take room");
  ASSERT_EQ(scan.status, 0) << scan.err;
  const Outcome info = take.mixrig("info room --json info.json --picture plan.png");
  ASSERT_EQ(info.status, 0) << info.err;
  EXPECT_NE(info.out.find("a room of 4 views, 4 frames"), std::string::npos) << info.out;
  EXPECT_NE(take.text_of("info.json").find("\"kind\": \"room\""), std::string::npos);
  Image<Rgb8> picture;
  ASSERT_TRUE(image_io::read_rgb8(take.path("plan.png"), picture));
  int wall = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) wall += picture.at(x, y) == Rgb8{100, 110, 120};
  EXPECT_GT(wall, 10000) << "the elevation shows the wall";
  const Outcome refused = take.mixrig("info take --picture plan.png");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("is not a scanned room"), std::string::npos) << refused.err;
  const Outcome of_room = take.mixrig("info room --depth");
  EXPECT_EQ(of_room.status, 2);
  EXPECT_NE(of_room.err.find("give the take that it was scanned from"), std::string::npos)
      << of_room.err;
  const Outcome no_truth = take.mixrig("info room --truth take");
  EXPECT_NE(no_truth.status, 0);
  EXPECT_NE(no_truth.err.find("truth"), std::string::npos) << no_truth.err;
}

TEST(CommandLine, InfoAndExplainDescribeATake) {
  const TinyTake take;
  const Outcome info = take.mixrig("info take --json info.json");
  EXPECT_EQ(info.status, 0) << info.err;
  EXPECT_NE(info.out.find("tiny: 4 frames"), std::string::npos) << info.out;
  const Outcome measured = take.mixrig("info take --depth --json depth.json");
  EXPECT_NE(measured.out.find("depth camera, 4 pictures"), std::string::npos) << measured.out;
  EXPECT_NE(take.text_of("depth.json").find("\"depth_camera\""), std::string::npos);
  EXPECT_NE(take.text_of("info.json").find("\"unknown_pct\": 0.0"), std::string::npos);
  const Outcome piped = take.mixrig("info take --json -");  // the report alone
  EXPECT_EQ(piped.status, 0) << piped.err;
  EXPECT_EQ(piped.out, take.text_of("info.json"));
  EXPECT_NE(piped.err.find("tiny: 4 frames"), std::string::npos) << piped.err;
  fs::copy(take.path("scene.toml"), take.path("take/scene.toml"));
  const Outcome explain = take.mixrig("explain take/scene.toml --backend cpu");  // finds its take
  EXPECT_EQ(explain.status, 0) << explain.err;
  EXPECT_NE(explain.out.find("no object"), std::string::npos) << explain.out;
}

}  // namespace
}  // namespace mixrig::test
