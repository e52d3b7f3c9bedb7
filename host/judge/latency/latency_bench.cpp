// SPDX-License-Identifier: Apache-2.0
#include "host/judge/latency/latency_bench.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/percentile.h"
#include "host/capture/open/open_source.h"
#include "host/judge/latency/played_rig.h"
#include "host/judge/measure/motion.h"

namespace mixrig::session {
namespace {

constexpr Duration kToStart = std::chrono::seconds(5);
constexpr double kMostDelay_s = 0.5;

/// Takes what is handed over, as a sink without a screen.
class LogSink final : public output::CompositeSink {
 public:
  LogSink(output::ShownLog& log, const Clock& clock) : log_(log), clock_(clock) {}
  std::string_view name() const override { return "log"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr& composite) override {
    const HostTime now = clock_.now();
    const capture::Capture& capture = *composite->capture;
    log_.add({capture.number, capture.mid_exposure, now, now, composite->frame_ms,
              measure::changed_column(composite->images.color.view(), log_.empty, log_.left_out)});
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  output::ShownLog& log_;
  const Clock& clock_;
};

/// Marks the virtual objects and what is near them: they look a little different in the truth,
/// which is no motion.
Image<std::uint8_t> around_objects(const Image<std::uint8_t>& labels) {
  constexpr int kNear_px = 6;
  Image<std::uint8_t> out(labels.size(), 0);
  for (int y = 0; y < labels.height(); ++y)
    for (int x = 0; x < labels.width(); ++x) {
      if ((labels.at(x, y) & capture::Truth::kVirtual) == 0) continue;
      for (int v = std::max(0, y - kNear_px); v < std::min(labels.height(), y + kNear_px + 1); ++v)
        std::fill(out.row(v) + std::max(0, x - kNear_px),
                  out.row(v) + std::min(labels.width(), x + kNear_px + 1), std::uint8_t{1});
    }
  return out;
}

/// Times of the frames of a take, and where its virtual objects are.
Result<std::vector<double>> read_times(capture::CaptureSource& source, LatencyBench& bench) {
  capture::Capture capture;
  capture::Truth truth;
  std::vector<double> times_s;
  for (int number = 1; number <= source.info().frames; ++number) {
    MIXRIG_ASSIGN(const bool there, source.read(number, capture));
    if (!there) break;
    times_s.push_back(capture.time_s);
    if (number > 1) continue;
    MIXRIG_TRY(source.read_truth(number, truth));
    bench.log.left_out = around_objects(truth.labels);
  }
  return times_s;
}

/// Takes the motion of a recording, with the first picture as the empty one.
class MotionSink final : public output::CompositeSink {
 public:
  MotionSink(const std::vector<double>& times_s, LatencyBench& bench)
      : times_s_(times_s), bench_(bench) {}
  std::string_view name() const override { return "motion"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr& composite) override {
    const Image<Rgb8>& color = composite->images.color;
    if (bench_.log.empty.empty()) bench_.log.empty = color;
    const auto at = static_cast<std::size_t>(composite->capture->number - 1);
    const auto column =
        measure::changed_column(color.view(), bench_.log.empty, bench_.log.left_out);
    if (column && at < times_s_.size()) bench_.motion.push_back({times_s_[at], *column});
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  const std::vector<double>& times_s_;
  LatencyBench& bench_;
};

/// The motion as the pipeline shows it when it has time. That of the true composites would differ
/// by the look of shadows and edges on the side from which somebody comes: 10 px, or 40 ms of a
/// walk.
Result<void> read_motion(const LatencyOptions& options, const std::vector<double>& times_s,
                         const Clock& clock, LatencyBench& bench) {
  MIXRIG_ASSIGN(const auto session, open_session({.scene = options.scene,
                                                  .source = "take:" + options.take.string(),
                                                  .view_size = options.view_size,
                                                  .backend = options.backend}));
  if (bench.log.left_out.size() != session->setup.view.size_px) bench.log.left_out = {};
  RunOptions run_options;
  run_options.frames = FrameRange{1, static_cast<int>(times_s.size())};
  run_options.judge = false;
  RunParts parts;
  parts.sinks.push_back(std::make_unique<MotionSink>(times_s, bench));
  MIXRIG_TRY(run(*session, run_options, clock, {}, std::move(parts)));
  bench.log.reserve(times_s.size());
  return {};
}

nlohmann::json quantiles(const std::vector<float>& ms) {
  return {{"p50", measure::quantile(ms, 0.5)},
          {"p95", measure::quantile(ms, 0.95)},
          {"p99", measure::quantile(ms, 0.99)},
          {"max", measure::quantile(ms, 1.0)}};
}

}  // namespace

std::unique_ptr<output::CompositeSink> make_log_sink(output::ShownLog& log, const Clock& clock) {
  return std::make_unique<LogSink>(log, clock);
}

Result<std::unique_ptr<LatencyBench>> prepare_latency(const LatencyOptions& options, Clock& clock,
                                                      const std::atomic<bool>& stop) {
  auto bench = std::make_unique<LatencyBench>();
  MIXRIG_ASSIGN(const auto take, open_source("take:" + options.take.string()));
  if (!take->info().has_truth || !(take->info().rate_hz > 0))
    return Error{ErrorCode::kData, options.take.string() +
                                       ": the delay is measured against truth at a rate: use a "
                                       "take of mixrig studio"};
  const HostTime reads = clock.now();
  MIXRIG_ASSIGN(const std::vector<double> times_s, read_times(*take, *bench));
  MIXRIG_TRY(read_motion(options, times_s, clock, *bench));
  // The take is read once more before it plays, without its truth.
  const HostTime begin = clock.now() + kToStart + 2 * (clock.now() - reads);
  // The player counts from its first frame.
  for (measure::Sample& sample : bench->motion) sample.time_s += seconds(begin.time_since_epoch());
  MIXRIG_ASSIGN(const std::filesystem::path rig,
                write_played_rig(options.folder, options.take, begin));
  SessionOptions session{.scene = options.scene,
                         .source = "rig:" + rig.string(),
                         .view_size = options.view_size,
                         .backend = options.backend};
  session.clock = &clock, session.stop = &stop, session.play.preload = true;
  MIXRIG_ASSIGN(bench->session, open_session(session));
  bench->view_px = bench->session->setup.view.size_px;
  return bench;
}

Result<LatencyReport> run_latency(LatencyBench& bench, std::unique_ptr<output::CompositeSink> sink,
                                  output::RunOrders& orders, const Clock& clock) {
  RunOptions options;
  options.judge = false;
  RunParts parts;
  parts.orders = &orders, parts.stop = &orders.stop();
  parts.sinks.push_back(std::move(sink));
  LatencyReport report;
  report.period_ms = 1e3 / bench.session->source->info().rate_hz;
  MIXRIG_ASSIGN(report.run, run(*bench.session, options, clock, {}, std::move(parts)));
  if (bench.log.frames.empty())
    return Error{ErrorCode::kData,
                 "no frame was shown, so the delay is not known: give a longer take"};
  std::vector<measure::Sample> seen;
  for (const output::ShownFrame& frame : bench.log.frames) {
    const auto ms = [](Duration time) { return static_cast<float>(milliseconds(time)); };
    report.total_ms.push_back(ms(frame.shown - frame.exposed));
    report.wait_ms.push_back(ms(frame.handed - frame.exposed) - frame.frame_ms);
    report.compose_ms.push_back(frame.frame_ms);
    report.show_ms.push_back(ms(frame.shown - frame.handed));
    if (frame.column) seen.push_back({seconds(frame.shown.time_since_epoch()), *frame.column});
  }
  report.frames = bench.log.frames.size();
  report.correlated = measure::delay_of_motion(bench.motion, seen, kMostDelay_s);
  return report;
}

nlohmann::json to_json(const LatencyReport& report) {
  nlohmann::json out{{"frames", report.frames},
                     {"period_ms", report.period_ms},
                     {"delay_ms", quantiles(report.total_ms)},
                     {"periods_p99", measure::quantile(report.total_ms, 0.99) / report.period_ms},
                     {"stages_ms",
                      {{"wait", quantiles(report.wait_ms)},
                       {"compose", quantiles(report.compose_ms)},
                       {"show", quantiles(report.show_ms)}}},
                     {"correlated", nullptr},
                     {"run", to_json(report.run)}};
  if (const auto& delay = report.correlated)
    out["correlated"] = {{"delay_ms", 1e3 * delay->delay_s},
                         {"sigma_ms", 1e3 * delay->uncertainty_s},
                         {"correlation", delay->correlation}};
  return out;
}

std::string to_table(const LatencyReport& report) {
  const auto row = [](const char* name, const std::vector<float>& ms) {
    return fmt::format("  {:<34} {:>8.1f} {:>8.1f} {:>8.1f}\n", name, measure::quantile(ms, 0.5),
                       measure::quantile(ms, 0.99), measure::quantile(ms, 1.0));
  };
  std::string out =
      fmt::format("{} frames, {:.1f} ms apart\n  {:<34} {:>8} {:>8} {:>8}\n", report.frames,
                  report.period_ms, "milliseconds", "p50", "p99", "max");
  out += row("received, paired, decoded, waited", report.wait_ms);
  out += row("composited", report.compose_ms);
  out += row("handed over, drawn, shown", report.show_ms);
  out += row("mid-exposure to shown", report.total_ms);
  out += fmt::format("  p99 is {:.2f} frame periods\n",
                     measure::quantile(report.total_ms, 0.99) / report.period_ms);
  if (const auto& delay = report.correlated)
    return out + fmt::format("  by the motions alone: {:.1f} +- {:.1f} ms (correlation {:.4f})\n",
                             1e3 * delay->delay_s, 1e3 * delay->uncertainty_s, delay->correlation);
  return out + "  by the motions alone: they cannot tell\n";
}

report::BarPlot plot_of(const LatencyReport& report) {
  report::BarPlot plot{
      .title = "Delay from mid-exposure to shown", .unit = "milliseconds", .bars = {}};
  for (const auto& [name, q] : {std::pair("median", 0.5), std::pair("99th percentile", 0.99)})
    plot.bars.push_back(
        {name,
         {{"received, paired, decoded, waited", measure::quantile(report.wait_ms, q)},
          {"composited", measure::quantile(report.compose_ms, q)},
          {"handed over, drawn, shown", measure::quantile(report.show_ms, q)}}});
  return plot;
}

}  // namespace mixrig::session
