// SPDX-License-Identifier: Apache-2.0
// The delay of the whole rig, measured with a lamp on a trigger line that the colour camera sees.
#include <cmath>
#include <fstream>

#include "tests/board/rig_bench.h"

namespace mixrig::board {
namespace {

constexpr int kLampLine = 7, kLampDivider = 97;
constexpr auto kLit = 310ms;
constexpr double kExposure_ms = 1;

TEST_F(Rig, ALampOnATriggerLineTellsTheDelayThatTheStampsTell) {
  if (run("mixrig bench --help").status != 0) GTEST_SKIP() << "bench needs a build with the studio";
  std::ofstream(kConfig, std::ios::app) << "[[trigger.line]]\nline = " << kLampLine
                                        << "\ndivider = " << kLampDivider << "\nwidth_ms = 310\n";
  HostTime lit_at{-kLit};  // used by the trigger's thread alone
  rig_.set_look([&](int line, device::PanTiltAngles, HostTime now) {
    if (line == kLampLine) lit_at = now;
    if (line != kColorLine) return;
    const std::uint8_t luma = now - lit_at < kLit ? 235 : 16;
    rig_.color.show(std::vector<std::uint8_t>(kColorSize.width, luma));
  });
  const Ran ran = run("mixrig bench --suite marker --rig " + std::string(kConfig) + " --line " +
                      std::to_string(kLampLine) + " --exposure-ms " + std::to_string(kExposure_ms) +
                      " --seconds 12 --out /tmp/marker --json " + kReport);
  rig_.set_look({});
  ASSERT_EQ(ran.status, 0) << ran.text;
  const Json report = read_json(kReport);
  const double delay_ms = report["delay_ms"], within_ms = report["within_ms"];
  const double stamped_ms = report["stamped_ms"];
  measured("%.1f +- %.1f ms by the lamp, %.1f ms by the stamps; %d pictures, %d switches", delay_ms,
           within_ms, stamped_ms, report["frames"].get<int>(), report["switches"].get<int>());
  EXPECT_GE(report["switches"].get<int>(), 16);
  EXPECT_GT(report["correlation"].get<double>(), 0.98);
  EXPECT_LE(std::abs(delay_ms - stamped_ms), within_ms + kExposure_ms);
}

}  // namespace
}  // namespace mixrig::board
