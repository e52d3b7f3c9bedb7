// SPDX-License-Identifier: Apache-2.0
#include "host/judge/latency/soak_bench.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "hal/base/quantile_sketch.h"
#include "host/judge/latency/played_rig.h"
#include "host/run/loop/run.h"

namespace mixrig::session {
namespace {

constexpr double kMostDuration_s = 24 * 3600, kMostSpeed = 1000;

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// Delays by the part of the run in which the picture was exposed. All memory is there before.
class SoakSink final : public output::CompositeSink {
 public:
  SoakSink(const Clock& clock, double duration_s, double speed)
      : clock_(clock), part_s_(duration_s / SoakReport::kParts), speed_(speed) {}

  std::string_view name() const override { return "soak"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr& composite) override {
    const capture::Capture& capture = *composite->capture;
    if (!first_s_) first_s_ = capture.time_s, numbers_.first = capture.number;
    numbers_.second = capture.number;
    const auto part = std::min(static_cast<std::size_t>(std::max(0.0, capture.time_s) / part_s_),
                               SoakReport::kParts - 1);
    delay_ms_[part].add(milliseconds(clock_.now() - capture.mid_exposure) / speed_);
    if (const HostTime now = host_.now(); now >= look_at_) {
      resident_mb_[part] = resident_mb();
      look_at_ = now + kLook;
    }
    return {};
  }
  Result<void> finish() override { return {}; }

  /// Time of the first composite after the first picture.
  double first_s() const { return first_s_.value_or(0); }
  /// Numbers of the first and the last capture.
  std::pair<int, int> numbers() const { return numbers_; }
  std::vector<SoakPart> parts() const {
    std::vector<SoakPart> parts;
    for (std::size_t i = 0; i < SoakReport::kParts; ++i)
      if (const measure::QuantileSketch& ms = delay_ms_[i]; ms.count() > 0)
        parts.push_back(
            {ms.count(), ms.quantile(0.5), ms.quantile(0.99), ms.max(), resident_mb_[i]});
    return parts;
  }

 private:
  static constexpr Duration kLook = std::chrono::milliseconds(250);
  const Clock& clock_;
  const SystemClock host_;
  const double part_s_, speed_;
  HostTime look_at_{};
  std::optional<double> first_s_;
  std::pair<int, int> numbers_{0, -1};
  std::array<measure::QuantileSketch, SoakReport::kParts> delay_ms_;
  std::array<double, SoakReport::kParts> resident_mb_{};
};

/// Hands on to a sink that the caller keeps.
class LentSink final : public output::CompositeSink {
 public:
  explicit LentSink(std::shared_ptr<output::CompositeSink> sink) : sink_(std::move(sink)) {}
  std::string_view name() const override { return sink_->name(); }
  render::OutputMask wanted(int number) const override { return sink_->wanted(number); }
  Result<void> write(const output::CompositePtr& composite) override {
    return sink_->write(composite);
  }
  Result<void> finish() override { return sink_->finish(); }

 private:
  const std::shared_ptr<output::CompositeSink> sink_;
};

Result<std::unique_ptr<Session>> open_soak(const SoakOptions& options, Clock& clock,
                                           const std::atomic<bool>& stop) {
  MIXRIG_ASSIGN(const auto take, open_source("take:" + options.take.string()));
  if (!(take->info().rate_hz > 0))
    return Error{ErrorCode::kData, options.take.string() + ": has no rate_hz: it cannot be played"};
  MIXRIG_ASSIGN(const auto rig, write_played_rig(options.folder, options.take, {}));
  SessionOptions session{.scene = options.scene,
                         .source = "rig:" + rig.string(),
                         .view_size = options.view_size,
                         .backend = options.backend};
  session.clock = &clock, session.stop = &stop;
  const auto frames = static_cast<int>(std::lround(options.duration_s * take->info().rate_hz));
  session.play = {.preload = true, .frames = std::max(1, frames)};
  return open_session(session);
}

/// Counts what became of the pictures. Captures are numbered where they are read, so gaps in the
/// numbers shown were dropped after reading; the other pictures were lost before.
void count_frames(const SoakSink& sink, int first_number, double rate_hz, SoakReport& report) {
  const capture::SourceReport live = report.run.live.value_or(capture::SourceReport{});
  if (!live.streams.empty()) {
    report.exposed = live.streams.front().health.frames;
    report.overrun = live.streams.front().health.overrun;
  }
  for (const output::SinkReport& of : report.run.sinks)
    if (of.name == "soak") report.shown = of.written, report.dropped_after = of.dropped;
  const auto [first, last] = sink.numbers();
  report.before = static_cast<std::uint64_t>(std::llround(sink.first_s() * rate_hz));
  const auto read = static_cast<std::uint64_t>(last - first + 1);
  const std::uint64_t gaps = read - report.shown - report.dropped_after;
  report.dropped_before = std::min(gaps, live.dropped_sets);
  // The counters of what lies before the reader also have what was lost while nothing was read.
  const std::uint64_t of_reader =
      gaps + static_cast<std::uint64_t>(std::max(0, first - first_number));
  const std::uint64_t counted =
      live.left_out + live.dropped_sets - std::min(live.dropped_sets, of_reader);
  const std::uint64_t lost = report.exposed - std::min(report.exposed, report.before + read);
  report.unpaired = std::min(lost, counted);
}

/// Mean of a value over the parts from `first` to before `last`, as shares of all of them.
template <typename Value>
double mean_of(const std::vector<SoakPart>& parts, double first, double last, Value value) {
  const auto n = static_cast<double>(parts.size());
  const auto begin = static_cast<std::size_t>(first * n), end = static_cast<std::size_t>(last * n);
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += value(parts[i]);
  return end > begin ? sum / static_cast<double>(end - begin) : 0;
}

}  // namespace

std::int64_t SoakReport::unexplained() const {
  return static_cast<std::int64_t>(exposed) -
         static_cast<std::int64_t>(before + shown + unpaired + dropped_before + dropped_after);
}

double SoakReport::drift_ms() const {
  const auto p50 = [](const SoakPart& part) { return part.p50_ms; };
  return mean_of(parts, 0.75, 1, p50) - mean_of(parts, 0.25, 0.5, p50);
}

double SoakReport::growth_mb() const {
  const auto mb = [](const SoakPart& part) { return part.resident_mb; };
  return mean_of(parts, 0.75, 1, mb) - mean_of(parts, 0.25, 0.5, mb);
}

Result<SoakReport> soak(const SoakOptions& options, const std::atomic<bool>& stop,
                        const ProgressFn& progress) {
  if (!(options.duration_s >= 1 && options.duration_s <= kMostDuration_s))
    return Error{ErrorCode::kUsage, "the frames of a soak last 1 s to 24 h"};
  if (!(options.speed >= 1 && options.speed <= kMostSpeed))
    return Error{ErrorCode::kUsage, "the clock of a soak runs 1 to 1000 times as fast"};
  FastClock clock(options.speed);
  MIXRIG_ASSIGN(const auto session, open_soak(options, clock, stop));
  const auto sink = std::make_shared<SoakSink>(clock, options.duration_s, options.speed);
  RunOptions run_options;
  run_options.judge = false;
  RunParts parts;
  parts.stop = &stop;
  parts.extras = options.extras;
  parts.sinks.push_back(std::make_unique<LentSink>(sink));
  SoakReport report;
  report.speed = options.speed;
  const SystemClock host;
  const HostTime begin = host.now();
  MIXRIG_ASSIGN(report.run, run(*session, run_options, clock, progress, std::move(parts)));
  report.real_s = seconds(host.now() - begin);
  report.parts = sink->parts();
  count_frames(*sink, session->default_frames().first, session->source->info().rate_hz, report);
  return report;
}

nlohmann::json to_json(const SoakReport& report) {
  nlohmann::json parts = nlohmann::json::array();
  for (const SoakPart& part : report.parts)
    parts.push_back(
        {{"frames", part.frames},
         {"delay_ms", {{"p50", part.p50_ms}, {"p99", part.p99_ms}, {"max", part.most_ms}}},
         {"resident_mb", part.resident_mb}});
  return {{"parts", parts},
          {"speed", report.speed},
          {"real_s", report.real_s},
          {"frames",
           {{"exposed", report.exposed},
            {"before", report.before},
            {"shown", report.shown},
            {"unpaired", report.unpaired},
            {"dropped_before", report.dropped_before},
            {"dropped_after", report.dropped_after},
            {"overrun", report.overrun},
            {"unexplained", report.unexplained()}}},
          {"drift_ms", report.drift_ms()},
          {"growth_mb", report.growth_mb()},
          {"run", to_json(report.run)}};
}

std::string to_table(const SoakReport& report) {
  std::string out = fmt::format("{:>5} {:>8} {:>9} {:>9} {:>9} {:>9}\n", "part", "frames", "p50 ms",
                                "p99 ms", "max ms", "MB");
  for (std::size_t i = 0; i < report.parts.size(); ++i) {
    const SoakPart& part = report.parts[i];
    out += fmt::format("{:>5} {:>8} {:>9.2f} {:>9.2f} {:>9.1f} {:>9.1f}\n", i + 1, part.frames,
                       part.p50_ms, part.p99_ms, part.most_ms, part.resident_mb);
  }
  out += fmt::format(
      "{:.0f} s, clock {:g} times as fast; {} pictures exposed: {} before the first composite, {} "
      "shown, {} "
      "without depth, {} and {} dropped before and after the compositor, {} unexplained; {} not "
      "delivered for want of a buffer\n",
      report.real_s, report.speed, report.exposed, report.before, report.shown, report.unpaired,
      report.dropped_before, report.dropped_after, report.unexplained(), report.overrun);
  return out + fmt::format("last quarter against the second: delay {:+.2f} ms, memory {:+.1f} MB\n",
                           report.drift_ms(), report.growth_mb());
}

}  // namespace mixrig::session
