// SPDX-License-Identifier: Apache-2.0
// A lamp on a trigger line as a camera sees it, in injected time, with a delay that is known.
#include "host/judge/latency/marker_bench.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "hal/base/srgb.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::session {
namespace {

constexpr Duration kTick = std::chrono::milliseconds(10);

/// A master whose crystal is 100 ppm fast, and that ticks by a test's clock.
class TickingSource final : public capture::CaptureSource {
 public:
  explicit TickingSource(const Clock& clock) : clock_(clock) {}
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int, capture::Capture&) override { return false; }
  Result<void> read_truth(int, capture::Truth&) override { return {}; }
  static double host_s(double tick) { return 100 + tick * 0.01 / 1.0001; }
  std::optional<capture::SourceReport> report() const override {
    const double now_s = seconds(clock_.now().time_since_epoch());
    capture::SourceReport report;
    const double tick = std::floor((now_s - 100) * 1.0001 / 0.01);
    report.newest_tick = {static_cast<std::uint64_t>(tick),
                          HostTime(Duration(std::llround(1e9 * host_s(tick))))};
    return report;
  }

 private:
  const Clock& clock_;
  capture::SourceInfo info_;
};

/// Share of an exposure in which the lamp was lit.
double lit(double middle_s, double exposure_s, const device::TriggerChannel& lamp) {
  constexpr int kParts = 400;
  int on = 0;
  for (int i = 0; i < kParts; ++i) {
    const double t_s = middle_s + exposure_s * ((i + 0.5) / kParts - 0.5);
    const double tick = (t_s - 100) * 1.0001 / 0.01 - seconds(lamp.phase) / seconds(kTick);
    on += std::fmod(tick, lamp.divider) * seconds(kTick) < seconds(lamp.width);
  }
  return static_cast<double>(on) / kParts;
}

output::CompositePtr seen_lamp(double share, double exposed_s) {
  auto composite = std::make_shared<output::Composite>();
  const auto capture = std::make_shared<capture::Capture>();
  capture->mid_exposure = HostTime(Duration(std::llround(1e9 * exposed_s)));
  composite->capture = capture;
  composite->images.color.reset({40, 30}, {60, 60, 60});
  const std::uint8_t v = srgb_byte_from_linear(static_cast<float>(0.05 + 0.8 * share));
  for (int y = 10; y < 14; ++y)
    for (int x = 20; x < 25; ++x) composite->images.color.at(x, y) = {v, v, v};
  return composite;
}

TEST(MarkerBench, FindsTheDelayOfALampWithinAnExposure) {
  const device::TriggerChannel lamp{97, std::chrono::milliseconds(23),
                                    std::chrono::milliseconds(310)};
  constexpr double kExposure_s = 0.008;
  for (const double delay_s : {0.021, 0.0567, 0.183}) {
    ManualClock clock;
    const TickingSource source(clock);
    MarkerLog log(500);
    const auto sink = make_marker_sink(log, MarkerRegion{19, 9, 7, 6}, source, clock);
    for (int i = 0; i < 500; ++i) {
      const double exposed_s = 101 + i / 25.0;
      clock.sleep_until(HostTime(Duration(std::llround(1e9 * (exposed_s + delay_s)))));
      ASSERT_TRUE(sink->write(seen_lamp(lit(exposed_s, kExposure_s, lamp), exposed_s)));
    }
    const auto switches_s = switches_of(log.ticks, lamp, kTick);
    EXPECT_GE(switches_s.size(), 36U);
    EXPECT_NEAR(switches_s[1] - switches_s[0], 0.310 / 1.0001, 1e-6);
    const auto found = measure::delay_of_marker(switches_s, log.seen, kExposure_s, 0.5);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->delay_s, delay_s, kExposure_s);
    EXPECT_LT(found->uncertainty_s, 0.01);
    EXPECT_NEAR(log.stamped_ms.quantile(0.5), 1e3 * delay_s, 1e-3 * 1e3 * delay_s);
  }
}

TEST(MarkerBench, AMasterThatRestartsCountsFromThereOn) {
  std::vector<sync::Tick> ticks;
  for (const auto& [tick, at_s] : {std::pair(900, 9.0), {1000, 10.0}, {5, 20.0}, {300, 22.95}})
    ticks.push_back(
        {static_cast<std::uint64_t>(tick), HostTime(Duration(std::llround(1e9 * at_s)))});
  const device::TriggerChannel lamp{100, Duration(0), std::chrono::milliseconds(200)};
  const auto switches_s = switches_of(ticks, lamp, kTick);
  ASSERT_EQ(switches_s.size(), 4U);
  EXPECT_NEAR(switches_s[0], 20.95, 1e-9);
  EXPECT_NEAR(switches_s[3], 22.15, 1e-9);
  EXPECT_TRUE(switches_of(std::span(ticks).first(1), lamp, kTick).empty());
  EXPECT_TRUE(switches_of(ticks, {}, kTick).empty());
}

TEST(MarkerBench, ARigWithoutThatLampIsRefusedInOneLine) {
  const test::TemporaryFolder folder;
  const std::string rig = folder / "rig.toml";
  std::ofstream(rig) << "format = 1\nname = \"r\"\n[trigger]\nuri = \"mcu:/dev/null\"\n"
                        "[[trigger.line]]\nline = 3\ndivider = 4\nwidth_ms = 1\n[[camera]]\n"
                        "name = \"color\"\nuri = \"v4l2:/dev/video99\"\n";
  SystemClock clock;
  const std::atomic<bool> stop = false;
  MarkerOptions options{.rig = rig, .folder = folder.path()};
  options.line = 7;
  auto refused = measure_marker(options, clock, stop);
  EXPECT_TRUE(test::refused(refused, {"line = 7"}));
  options.line = 3;
  refused = measure_marker(options, clock, stop);
  EXPECT_TRUE(test::refused(refused, {"exposure_ms"}));
  options.exposure_s = 0.008;
  refused = measure_marker(options, clock, stop);
  EXPECT_TRUE(test::refused(refused, {"blinks every 0.04 s"}));
}

}  // namespace
}  // namespace mixrig::session
