// SPDX-License-Identifier: Apache-2.0
// `mixrig scan --rig` with an emulated pan-tilt unit behind a serial line.
#include "tests/e2e/live_scan.h"
#include "tests/support/ptu_on_a_pty.h"

namespace mixrig::test {
namespace {

/// The studio's cameras stand still, since the studio's head is not used: only the unit is under
/// test.
TEST_F(LiveScan, ASerialUnitThatFallsSilentEndsItAndAnswersAgain) {
  PtuOnAPty unit;
  if (unit.name().empty()) GTEST_SKIP() << "no pseudo-terminal is available here";
  make_take();
  const std::string studio = "uri = \"studio:sweep,31,sr3000,,64x48/";
  write_rig("rig.toml",
            "calibration = \"take/truth/calibration.toml\"\n[[camera]]\nname = \"color\"\n" +
                studio + "target\"\n[depth]\n" + studio +
                "tof\"\n[pan_tilt]\nuri = \"flir-ptu:" + unit.name() + "\"\n");
  {
    std::vector<std::string> words = scan("0.1", "80x30");
    words.insert(words.begin(), MIXRIG_COMMAND);
    ChildProcess first(std::move(words), 120, path("first"));
    ASSERT_TRUE(comes_true([&] { return fs::exists(path("room.sweep/take.toml")); }));
    unit.set_silent(true);
    EXPECT_EQ(first.wait(), 1);
  }
  const std::string why = text_of("first");
  EXPECT_NE(why.find("pan-tilt unit"), std::string::npos) << why;
  EXPECT_NE(why.find("the same command goes on with the next"), std::string::npos) << why;
  unit.set_silent(false);
  const auto [status, log] = tried(scan("0.1", "80x30"));
  ASSERT_EQ(status, 0) << log;
  EXPECT_GE(report("room.json").at("sweep").at("resumed").get<int>(), 1);
  const std::vector<double> pan = column(path("room.sweep/pan_tilt.csv"), 1);
  const std::vector<double> planned = column(path("take/pan_tilt.csv"), 1);
  ASSERT_EQ(pan.size(), 4U);
  for (std::size_t i = 0; i < pan.size(); ++i) EXPECT_NEAR(pan[i], planned[i], 1e-3) << i;
}

}  // namespace
}  // namespace mixrig::test
