// SPDX-License-Identifier: Apache-2.0
// `mixrig scan --rig` with the studio's cameras and head: interrupted, refused with another plan,
// resumed, and compared with the recorded sweep of the same seed.
#include "tests/e2e/live_scan.h"

namespace mixrig::test {
namespace {

TEST_F(LiveScan, GoesOnAfterAnInterruptionAndIsAsGoodAsARecordedSweep) {
  make_take();
  write_rig("rig.toml", live_rig());
  {
    std::vector<std::string> words = scan("0.1");
    words.insert(words.begin(), MIXRIG_COMMAND);
    ChildProcess first(std::move(words), 120, path("first"));
    ASSERT_TRUE(comes_true([&] { return fs::exists(path("room.sweep/take.toml")); }));
    first.signal(SIGINT);
    EXPECT_EQ(first.wait(), 1);
  }
  EXPECT_NE(text_of("first").find("of 6 views, which are kept"), std::string::npos)
      << text_of("first");
  EXPECT_FALSE(fs::exists(path("room")));
  ASSERT_EQ(mixrig("scan --take " + path("room.sweep") + " --calibration " +
                   path("room.sweep/calibration.toml") + " " + path("part")),
            0);

  const auto [other, why] = tried(scan("0.3"));
  EXPECT_EQ(other, 2);
  EXPECT_NE(why.find("another overlap"), std::string::npos) << why;

  const auto [status, log] = tried(scan("0.1"));
  ASSERT_EQ(status, 0) << log;
  const auto room = report("room.json");
  EXPECT_EQ(room.at("views").get<int>(), 6);
  EXPECT_EQ(room.at("frames").get<int>(), 12);
  EXPECT_GE(room.at("sweep").at("resumed").get<int>(), 1);
  EXPECT_TRUE(fs::exists(path("room/room.exr")));

  fs::copy(path("take/truth"), path("room.sweep/truth"), fs::copy_options::recursive);
  const auto live = judged("room.sweep"), recorded = judged("take");
  for (const char* key : {"p50_mm", "p95_mm", "over_20mm_pct"})
    EXPECT_LT(live.at("surface").at(key).get<double>(),
              1.15 * recorded.at("surface").at(key).get<double>() + 0.1)
        << key;
}

TEST_F(LiveScan, EachMistakeIsOneLine) {
  const auto expect = [&](const std::string& rig, const char* words) {
    write_rig("rig.toml", rig);
    const auto [status, log] = tried({"scan", "--rig", path("rig.toml"), path("room")});
    EXPECT_EQ(status, 2) << log;
    EXPECT_NE(log.find(words), std::string::npos) << log;
    EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 1) << log;
    EXPECT_FALSE(fs::exists(path("room.sweep")));
  };
  const std::string camera = "[[camera]]\nname = \"color\"\nuri = \"studio:sweep/target\"\n";
  const std::string depth = "[depth]\nuri = \"studio:sweep/tof\"\n";
  const std::string head = "[pan_tilt]\nuri = \"studio:sweep/head\"\n";
  expect(camera + depth, "no pan-tilt unit");
  expect(camera + head, "no depth camera");
  expect(camera + depth + head, "--calibration");
  std::ofstream(path("c.toml")) << "format = 1\n";
  expect("calibration = \"c.toml\"\n" + camera + depth + head, "calibrate ptu");
  fs::create_directories(path("room"));
  std::ofstream(path("room/mine.txt")) << "x";
  make_take();
  expect(live_rig(), "holds other files");
}

}  // namespace
}  // namespace mixrig::test
