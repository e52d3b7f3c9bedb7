// SPDX-License-Identifier: Apache-2.0
// Endurance test: a take is played again and again as the devices of a live rig. Finds whether the
// delay drifts, memory grows, or a frame is lost without a reason.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/run/report/run_report.h"
#include "host/run/session/session.h"

namespace mixrig::session {

struct SoakOptions {
  std::filesystem::path scene{}, take{};
  std::filesystem::path folder{};  ///< folder for rig.toml
  double duration_s = 1200;        ///< duration of the frames, by their own times
  double speed = 1;  ///< factor by which the clock of devices and pairing is faster than real time
  std::optional<Size> view_size{};
  BackendChoice backend{};
  RunExtras extras{};  ///< extras that run as well
};

/// A clock that runs `speed` times as fast as the host's, from its construction on. Thread-safe.
class FastClock final : public Clock {
 public:
  explicit FastClock(double speed) : speed_(speed), begin_(host_.now()) {}
  HostTime now() const override { return begin_ + scaled(host_.now() - begin_, speed_); }
  void sleep_until(HostTime until) override {
    host_.sleep_until(begin_ + scaled(until - begin_, 1 / speed_));
  }

 private:
  static Duration scaled(Duration time, double factor) {
    return Duration(static_cast<Duration::rep>(static_cast<double>(time.count()) * factor));
  }
  const double speed_;
  SystemClock host_;
  const HostTime begin_;
};

/// Figures of a twelfth of the run.
struct SoakPart {
  std::uint64_t frames = 0;                    ///< frames that the sink got
  double p50_ms = 0, p99_ms = 0, most_ms = 0;  ///< mid-exposure to sink, in host time
  double resident_mb = 0;                      ///< resident memory at the end of the part
};

struct SoakReport {
  static constexpr std::size_t kParts = 12;
  std::vector<SoakPart> parts;
  double speed = 1, real_s = 0;
  std::uint64_t exposed = 0;   ///< pictures of the colour camera
  std::uint64_t before = 0;    ///< before the first composite: the background is being learned
  std::uint64_t shown = 0;     ///< composites that the sink got
  std::uint64_t overrun = 0;   ///< pictures lost because no buffer was free
  std::uint64_t unpaired = 0;  ///< pictures without depth in time, or dropped before they were read
  /// Dropped by the queues before and after the compositor.
  std::uint64_t dropped_before = 0, dropped_after = 0;
  RunReport run;

  /// Number of pictures since the first composite that were neither shown nor counted by name.
  std::int64_t unexplained() const;
  /// Median delay of the last quarter less that of the second quarter, since the first one warms
  /// up.
  double drift_ms() const;
  /// Resident memory of the last quarter less that of the second.
  double growth_mb() const;
};

/// Runs the test. Errors: kUsage for a duration or speed out of range; those of scene, take and
/// run(). `stop` ends it early; the report then covers the frames so far.
Result<SoakReport> soak(const SoakOptions& options, const std::atomic<bool>& stop,
                        const ProgressFn& progress);

nlohmann::json to_json(const SoakReport& report);
std::string to_table(const SoakReport& report);

}  // namespace mixrig::session
