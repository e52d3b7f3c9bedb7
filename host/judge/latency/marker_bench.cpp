// SPDX-License-Identifier: Apache-2.0
#include "host/judge/latency/marker_bench.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/partial_path.h"
#include "hal/base/srgb.h"
#include "host/capture/live/rig/rig_config.h"
#include "host/run/loop/run.h"
#include "host/run/session/session.h"

namespace mixrig::session {
namespace {

constexpr double kMostMarkerDelay_s = 0.5;
constexpr double kMostRate_hz = 250;  // of pictures, for the memory of the log
constexpr Duration kMasterTick = std::chrono::milliseconds(10);

class MarkerSink final : public output::CompositeSink {
 public:
  MarkerSink(MarkerLog& log, std::optional<MarkerRegion> region,
             const capture::CaptureSource& source, const Clock& clock)
      : log_(log), region_(region), source_(source), clock_(clock) {}
  std::string_view name() const override { return "marker"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr& composite) override {
    const HostTime now = clock_.now();
    if (log_.seen.size() < log_.seen.capacity()) {
      log_.seen.push_back({seconds(now.time_since_epoch()), light_of(composite->images.color)});
      log_.stamped_ms.add(milliseconds(now - composite->capture->mid_exposure));
    }
    const auto report = source_.report();
    if (!report || !report->newest_tick || log_.ticks.size() == log_.ticks.capacity()) return {};
    const sync::Tick tick = *report->newest_tick;
    if (log_.ticks.empty() || log_.ticks.back().sequence != tick.sequence)
      log_.ticks.push_back(tick);
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  double light_of(const Image<Rgb8>& picture) const {
    const MarkerRegion all{0, 0, picture.width(), picture.height()};
    const MarkerRegion region = region_.value_or(all);
    const int right = std::min(region.x + region.width, picture.width());
    const int bottom = std::min(region.y + region.height, picture.height());
    const std::array<float, 256>& linear = linear_of_srgb_bytes();
    double sum = 0, count = 0;
    for (int y = std::max(0, region.y); y < bottom; ++y)
      for (int x = std::max(0, region.x); x < right; ++x, ++count)
        sum += linear[picture.at(x, y).r] + linear[picture.at(x, y).g] + linear[picture.at(x, y).b];
    return count > 0 ? sum / count : 0;
  }

  MarkerLog& log_;
  const std::optional<MarkerRegion> region_;
  const capture::CaptureSource& source_;
  const Clock& clock_;
};

Error marker_error(const MarkerOptions& options, const std::string& what) {
  return {ErrorCode::kUsage, options.rig.string() + ": " + what};
}

/// The lamp's line, and the exposure of the camera that sees it.
Result<device::TriggerChannel> lamp_of(const MarkerOptions& options, const live::RigConfig& rig,
                                       double& exposure_s) {
  const live::TriggerLine* const line = rig.line(options.line);
  if (line == nullptr || line->channel.divider < 1)
    return marker_error(options, fmt::format("has no [[trigger.line]] with line = {}: the lamp's "
                                             "line, with divider = 97 and width_ms = 310",
                                             options.line));
  if (exposure_s <= 0 && !rig.cameras.empty())
    exposure_s = rig.cameras.front().exposure_s.value_or(0);
  if (exposure_s <= 0)
    return marker_error(options,
                        "does not tell the exposure of its first camera: give exposure_ms there, "
                        "or --exposure-ms");
  const double period_s = line->channel.divider * seconds(kMasterTick);
  const double lit_s = seconds(line->channel.width);
  if (period_s < kMostMarkerDelay_s || lit_s < exposure_s || period_s - lit_s < exposure_s)
    return marker_error(options, fmt::format("line {} blinks every {:.2f} s for {:.3f} s: 0.5 s at "
                                             "least, lit and dark for an exposure each",
                                             options.line, period_s, lit_s));
  return line->channel;
}

Result<std::filesystem::path> scene_of(const MarkerOptions& options) {
  if (!options.scene.empty()) return options.scene;
  std::error_code ignored;  // writing says what is wrong
  std::filesystem::create_directories(options.folder, ignored);
  const std::filesystem::path file = options.folder / "marker_scene.toml";
  MIXRIG_TRY(write_file(file, "[camera]\npose = \"identity\"\n"));
  return file;
}

/// Line through the ticks: host seconds of tick number `origin`, and seconds of a tick.
struct TickLine {
  double origin = 0, at_s = 0, tick_s = 0;
  double time_s(double tick) const { return at_s + (tick - origin) * tick_s; }
};

TickLine line_through(std::span<const sync::Tick> ticks) {
  double mean_tick = 0, mean_s = 0, covariance = 0, variance = 0;
  const auto n = static_cast<double>(ticks.size());
  for (const sync::Tick& tick : ticks)
    mean_tick += static_cast<double>(tick.sequence) / n,
        mean_s += seconds(tick.at.time_since_epoch()) / n;
  for (const sync::Tick& tick : ticks) {
    const double off = static_cast<double>(tick.sequence) - mean_tick;
    covariance += off * (seconds(tick.at.time_since_epoch()) - mean_s), variance += off * off;
  }
  return {mean_tick, mean_s, variance > 0 ? covariance / variance : 0};
}

}  // namespace

std::unique_ptr<output::CompositeSink> make_marker_sink(MarkerLog& log,
                                                        std::optional<MarkerRegion> region,
                                                        const capture::CaptureSource& source,
                                                        const Clock& clock) {
  return std::make_unique<MarkerSink>(log, region, source, clock);
}

std::vector<double> switches_of(std::span<const sync::Tick> ticks,
                                const device::TriggerChannel& channel, Duration period) {
  const auto restart = std::adjacent_find(
      ticks.rbegin(), ticks.rend(),
      [](const auto& later, const auto& earlier) { return earlier.sequence > later.sequence; });
  if (restart != ticks.rend())
    ticks = ticks.subspan(static_cast<std::size_t>(ticks.rend() - restart) - 1);
  if (ticks.size() < 2 || channel.divider < 1) return {};
  const TickLine line = line_through(ticks);
  const double phase = seconds(channel.phase) / seconds(period);
  const double width = seconds(channel.width) / seconds(period);
  const auto divider = static_cast<double>(channel.divider);
  std::vector<double> switches_s;
  const auto last = static_cast<double>(ticks.back().sequence);
  double on = std::ceil(static_cast<double>(ticks.front().sequence) / divider) * divider;
  for (; on + phase + width <= last; on += divider) {
    switches_s.push_back(line.time_s(on + phase));
    switches_s.push_back(line.time_s(on + phase + width));
  }
  return switches_s;
}

Result<MarkerReport> measure_marker(const MarkerOptions& options, Clock& clock,
                                    const std::atomic<bool>& stop) {
  MIXRIG_ASSIGN(const live::RigConfig rig, live::read_rig(options.rig));
  MarkerReport report;
  report.exposure_s = options.exposure_s;
  MIXRIG_ASSIGN(const device::TriggerChannel lamp, lamp_of(options, rig, report.exposure_s));
  report.blink_s = lamp.divider * seconds(kMasterTick);
  MIXRIG_ASSIGN(const std::filesystem::path scene, scene_of(options));
  SessionOptions session_options;
  session_options.scene = scene, session_options.source = "rig:" + options.rig.string();
  session_options.clock = &clock, session_options.stop = &stop;
  MIXRIG_ASSIGN(const auto session, open_session(session_options));
  const double rate_hz = std::clamp(session->source->info().rate_hz, 1.0, kMostRate_hz);
  const auto frames = static_cast<std::size_t>(std::ceil(options.duration_s * rate_hz));
  MarkerLog log(frames);
  RunOptions run_options;
  run_options.judge = false;
  run_options.frames = FrameRange{1, static_cast<int>(frames)};
  RunParts parts;
  parts.stop = &stop;
  parts.sinks.push_back(make_marker_sink(log, options.region, *session->source, clock));
  MIXRIG_TRY(run(*session, run_options, clock, {}, std::move(parts)));
  const std::vector<double> switches_s = switches_of(log.ticks, lamp, kMasterTick);
  const auto delay =
      measure::delay_of_marker(switches_s, log.seen, report.exposure_s, kMostMarkerDelay_s);
  if (!delay)
    return Error{ErrorCode::kData,
                 fmt::format("line {} was switched {} times, and {} pictures do not show a lamp "
                             "that blinks so: give its pixels by --region, and let it run longer",
                             options.line, switches_s.size(), log.seen.size())};
  report.delay = *delay;
  report.stamped_s = log.stamped_ms.quantile(0.5) / 1e3;
  report.frames = log.seen.size(), report.switches = switches_s.size();
  return report;
}

nlohmann::json to_json(const MarkerReport& report) {
  return {{"delay_ms", 1e3 * report.delay.delay_s},
          {"within_ms", 1e3 * report.delay.uncertainty_s},
          {"correlation", report.delay.correlation},
          {"stamped_ms", 1e3 * report.stamped_s},
          {"exposure_ms", 1e3 * report.exposure_s},
          {"blink_s", report.blink_s},
          {"frames", report.frames},
          {"switches", report.switches}};
}

std::string to_table(const MarkerReport& report) {
  return fmt::format(
      "middle of the exposure to the composite in a sink: {:.1f} +- {:.1f} ms, by {} pictures of a "
      "lamp that was switched {} times (correlation {:.4f}, exposure {:.1f} ms); by the stamps "
      "{:.1f} ms\n",
      1e3 * report.delay.delay_s, 1e3 * report.delay.uncertainty_s, report.frames, report.switches,
      report.delay.correlation, 1e3 * report.exposure_s, 1e3 * report.stamped_s);
}

}  // namespace mixrig::session
