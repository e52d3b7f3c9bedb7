// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/capture/live/check/diagnose.h"

namespace mixrig::live {
namespace {

StreamReport healthy() {
  StreamReport report;
  report.name = "color";
  report.health.frames = 250;
  report.pairing.by_status[static_cast<std::size_t>(sync::PairStatus::kPaired)] = 248;
  report.pairing.by_status[static_cast<std::size_t>(sync::PairStatus::kLocking)] = 2;
  report.residual_sd_ms = 0.3;
  report.drift_ppm = 35;
  return report;
}

Verdict of(const std::vector<Check>& checks, const std::string& what) {
  for (const Check& check : checks)
    if (check.what == what) return check.verdict;
  ADD_FAILURE() << "no check of " << what;
  return Verdict::kFail;
}

TEST(Judge, AHealthyStreamPassesWithoutAdvice) {
  const auto checks = judge_stream(healthy(), 25, 10, true);
  EXPECT_EQ(worst(checks), Verdict::kPass);
  for (const Check& check : checks) EXPECT_TRUE(check.advice.empty()) << check.what;
}

TEST(Judge, EachFaultIsFoundWhereItIsAndNowhereElse) {
  struct Case {
    const char* what;
    Verdict verdict;
    void (*harm)(StreamReport&);
  };
  const Case cases[] = {
      {"rate", Verdict::kFail, [](StreamReport& r) { r.health.frames = 150; }},
      {"lost", Verdict::kWarn, [](StreamReport& r) { r.health.lost = 2; }},
      {"lost", Verdict::kFail, [](StreamReport& r) { r.health.incomplete = 20; }},
      {"link", Verdict::kWarn, [](StreamReport& r) { r.health.returns = 1; }},
      {"clock", Verdict::kWarn, [](StreamReport& r) { r.drift_ppm = -390; }},
      {"clock", Verdict::kFail, [](StreamReport& r) { r.drift_ppm = 1500; }},
      {"pairing", Verdict::kWarn, [](StreamReport& r) { r.residual_mean_ms = 4; }},
      {"pairing", Verdict::kFail, [](StreamReport& r) { r.pairing.by_status = {}; }},
  };
  for (const Case& c : cases) {
    StreamReport report = healthy();
    c.harm(report);
    const auto checks = judge_stream(report, 25, 10, true);
    EXPECT_EQ(of(checks, c.what), c.verdict) << c.what;
    for (const Check& check : checks) {
      if (check.what == c.what) {
        EXPECT_FALSE(check.advice.empty());
      }
      // Fewer frames than were paired also affects the pairing.
      if (check.what != c.what && std::string(c.what) != "rate") {
        EXPECT_EQ(check.verdict, Verdict::kPass) << check.what;
      }
    }
  }
}

TEST(Judge, NoFramesIsOneClearFailure) {
  StreamReport report;
  const auto checks = judge_stream(report, 25, 10, true);
  ASSERT_EQ(checks.size(), 1U);
  EXPECT_EQ(checks[0].verdict, Verdict::kFail);
  EXPECT_NE(checks[0].advice.find("trigger line"), std::string::npos);
}

TEST(Judge, RepeatabilityIsMeasuredInSteps) {
  const device::PanTiltAngles step{0.001, 0.001};
  EXPECT_EQ(judge_repeatability({{0.5, 0.1}, {0.5, 0.1}, {0.501, 0.1}}, step).verdict,
            Verdict::kPass);
  EXPECT_EQ(judge_repeatability({{0.5, 0.1}, {0.502, 0.1}}, step).verdict, Verdict::kWarn);
  EXPECT_EQ(judge_repeatability({{0.5, 0.1}, {0.5, 0.12}}, step).verdict, Verdict::kFail);
}

}  // namespace
}  // namespace mixrig::live
