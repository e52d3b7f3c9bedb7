// SPDX-License-Identifier: Apache-2.0
// Limits of mixrig diag, in one place.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/capture/live/check/diagnose.h"

namespace mixrig::live {
namespace {

constexpr double kRateWarn = 0.02, kRateFail = 0.10;   // relative to nominal
constexpr double kLostWarn = 0.001, kLostFail = 0.02;  // share of the frames
constexpr double kDriftWarn_ppm = 200, kDriftFail_ppm = 1000;
constexpr double kResidualWarn_ms = 2, kResidualFail_ms = 10;
constexpr double kEdgeWarn_ms = 1, kEdgeFail_ms = 5;     // half a tick: another tick fits better
constexpr double kPairedWarn = 0.99, kPairedFail = 0.9;  // share of the frames after locking

Verdict grade(double value, double warn, double fail) {
  return value > fail ? Verdict::kFail : value > warn ? Verdict::kWarn : Verdict::kPass;
}

Check make(const std::string& device, const char* what, Verdict verdict, std::string value,
           const char* advice) {
  return {device, what, verdict, std::move(value), verdict == Verdict::kPass ? "" : advice};
}

}  // namespace

std::string_view name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kWarn:
      return "warn";
    case Verdict::kFail:
      return "fail";
  }
  return "fail";
}

std::vector<Check> judge_stream(const StreamReport& report, double nominal_rate_hz,
                                double watched_s, bool triggered) {
  std::vector<Check> checks;
  const auto add = [&](const char* what, Verdict verdict, std::string value, const char* advice) {
    checks.push_back(make(report.name, what, verdict, std::move(value), advice));
  };
  const device::StreamHealth& health = report.health;
  const double frames = static_cast<double>(health.frames);
  const double rate_hz = watched_s > 0 ? frames / watched_s : 0;
  if (health.frames == 0) {
    add("rate", Verdict::kFail, "no frames",
        triggered ? "check the trigger line and its divider" : "check cable, power and bandwidth");
    return checks;
  }
  const double off = nominal_rate_hz > 0 ? std::abs(rate_hz / nominal_rate_hz - 1) : 0;
  // One frame more or less at each end of the window is not a fault.
  const double slack = nominal_rate_hz > 0 ? 2 / (nominal_rate_hz * watched_s) : 0;
  add("rate", grade(off - slack, kRateWarn, kRateFail),
      fmt::format("{:.2f} Hz of {:.2f}", rate_hz, nominal_rate_hz),
      "shorten the exposure, or check bandwidth and the trigger's divider");
  const double missing = static_cast<double>(health.lost + health.incomplete + health.overrun);
  add("lost", grade(missing / (frames + missing), kLostWarn, kLostFail),
      fmt::format("{} lost, {} incomplete, {} overrun", health.lost, health.incomplete,
                  health.overrun),
      "check cable, bus bandwidth and the load of the host");
  add("link", health.link_errors > 0 || health.returns > 0 ? Verdict::kWarn : Verdict::kPass,
      fmt::format("{} errors, {} returns", health.link_errors, health.returns),
      "check the cable and its plugs");
  if (report.drift_ppm != 0)
    add("clock", grade(std::abs(report.drift_ppm), kDriftWarn_ppm, kDriftFail_ppm),
        fmt::format("{:.1f} ppm, jitter {:.2f} ms", report.drift_ppm, report.jitter_ms),
        "the camera's clock is faulty");
  const double usable = static_cast<double>(report.pairing.of(sync::PairStatus::kPaired) +
                                            report.pairing.of(sync::PairStatus::kReordered));
  std::uint64_t seen = 0;
  for (const std::uint64_t count : report.pairing.by_status) seen += count;
  const double judged =
      std::max(1.0, static_cast<double>(seen - report.pairing.of(sync::PairStatus::kLocking)));
  const double residual_ms =
      triggered ? std::abs(report.residual_mean_ms) + report.residual_sd_ms : 0;
  const double unpaired = 1 - usable / judged;
  const Verdict pairing = std::max(grade(unpaired, 1 - kPairedWarn, 1 - kPairedFail),
                                   grade(residual_ms, kResidualWarn_ms, kResidualFail_ms));
  add("pairing", usable == 0 ? Verdict::kFail : pairing,
      fmt::format("{:.1f} % paired, residual {:.2f} +- {:.2f} ms, {} relocks",
                  100 * usable / judged, report.residual_mean_ms, report.residual_sd_ms,
                  report.pairing.relocks),
      "check the trigger wire; set delay_ms to the mean residual");
  return checks;
}

Check judge_edges(const sync::EdgeCounts& edges, double nominal_rate_hz, double watched_s,
                  bool master) {
  if (edges.edges == 0)
    return make("trigger_edges", "edges", Verdict::kFail, "none",
                "check the wire from the trigger to this host, and that the line is enabled");
  const double seen = static_cast<double>(edges.edges), wanted = nominal_rate_hz * watched_s;
  const double off = wanted > 0 ? std::max(0.0, std::abs(seen - wanted) - 2) / wanted : 0;
  const double wrong = static_cast<double>(edges.lost + edges.doubled) / seen;
  Verdict verdict = std::max(grade(off, kRateWarn, kRateFail), grade(wrong, kLostWarn, kLostFail));
  std::string value = fmt::format("{:.2f} Hz of {:.2f}, {} lost, {} doubled", seen / watched_s,
                                  nominal_rate_hz, edges.lost, edges.doubled);
  if (master) {
    verdict = std::max(verdict, grade(std::abs(edges.offset_mean_ms) + edges.offset_sd_ms,
                                      kEdgeWarn_ms, kEdgeFail_ms));
    value += fmt::format(", {:+.3f} +- {:.3f} ms from the master's tick, {:+.3f} at most",
                         edges.offset_mean_ms, edges.offset_sd_ms, edges.offset_max_ms);
  }
  return make("trigger_edges", "edges", verdict, std::move(value),
              "check line, divider and phase in rig.toml, the wire, and the link to the trigger");
}

Check judge_repeatability(const std::vector<device::PanTiltAngles>& positions,
                          device::PanTiltAngles step) {
  double pan_low = 1e9, pan_high = -1e9, tilt_low = 1e9, tilt_high = -1e9;
  for (const auto& p : positions) {
    pan_low = std::min(pan_low, p.pan_rad), pan_high = std::max(pan_high, p.pan_rad);
    tilt_low = std::min(tilt_low, p.tilt_rad), tilt_high = std::max(tilt_high, p.tilt_rad);
  }
  const double spread =
      std::max((pan_high - pan_low) / step.pan_rad, (tilt_high - tilt_low) / step.tilt_rad);
  return make("pan_tilt", "repeatability", grade(spread, 1.01, 3.01),
              fmt::format("{:.1f} steps over {} visits", spread, positions.size()),
              "check load, speed and power of the head");
}

Verdict worst(const std::vector<Check>& checks) {
  Verdict verdict = Verdict::kPass;
  for (const Check& check : checks) verdict = std::max(verdict, check.verdict);
  return verdict;
}

}  // namespace mixrig::live
