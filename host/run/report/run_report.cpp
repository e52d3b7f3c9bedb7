// SPDX-License-Identifier: Apache-2.0
#include "host/run/report/run_report.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/recent_log.h"
#include "host/output/report/rig_json.h"
#include "host/run/report/error_report.h"
#include "host/run/watchers/room_changes_report.h"

namespace mixrig::session {
namespace {

/// Quantile in three digits, which is the accuracy of the sketch.
double quantile(const measure::QuantileSketch& sketch, double q) {
  return rounded(sketch.quantile(q), 3);
}

nlohmann::json three_quantiles(const measure::QuantileSketch& sketch) {
  return {{"p50", quantile(sketch, 0.5)},
          {"p95", quantile(sketch, 0.95)},
          {"p99", quantile(sketch, 0.99)}};
}

bool ran(const measure::QuantileSketch& times_ms) { return times_ms.max() > 0.0; }

std::string live_line(const capture::SourceReport& live) {
  std::string line = fmt::format("  live: {} frame sets, {} dropped, {} without colour or depth\n",
                                 live.sets, live.dropped_sets, live.left_out);
  if (live.without_depth + live.held_depth > 0)
    line += fmt::format(
        "  depth was lost: {} frames without, in which nobody is keyed; {} with the "
        "depth before\n",
        live.without_depth, live.held_depth);
  return line;
}

/// The sinks that were too slow.
std::string sink_lines(const std::vector<output::SinkReport>& sinks) {
  std::string lines;
  for (const output::SinkReport& sink : sinks)
    if (sink.dropped > 0)
      lines += fmt::format("  sink {}: {} frames written, {} dropped because it was too slow\n",
                           sink.name, sink.written, sink.dropped);
  return lines;
}

/// The reasons that occurred, by name.
nlohmann::json lost_by_reason(const pose::FramePoseCounts& counts) {
  nlohmann::json out = nlohmann::json::object();
  for (std::size_t i = 1; i < counts.frames.size(); ++i)
    if (counts.frames[i] > 0)
      out[std::string(capture::name(static_cast<capture::PoseLoss>(i)))] = counts.frames[i];
  return out;
}

/// Share of lost packets among those sent, percent.
double lost_pct(const PoseReport& report) {
  const double lost = static_cast<double>(report.faults.packets_lost);
  const double sent = lost + static_cast<double>(report.stream->packets);
  return sent > 0 ? 100 * lost / sent : 0;
}

nlohmann::json to_json(const capture::PoseFaults& faults) {
  return {
      {"not_finite", faults.not_finite},           {"jumps", faults.jumps},
      {"clock_steps", faults.clock_steps},         {"refused", faults.refused},
      {"packets_lost", faults.packets_lost},       {"packets_late", faults.packets_late},
      {"packets_bad", faults.packets_bad},         {"packets_version", faults.packets_version},
      {"packets_foreign", faults.packets_foreign}, {"packets_unstamped", faults.packets_unstamped}};
}

nlohmann::json to_json(const SlipReport::Measured& slip) {
  return {{"rms", rounded(slip.rms_px)},
          {"p95", rounded(slip.p95_px, 3)},
          {"max", rounded(slip.max_px)}};
}

/// Counts of faults, and figures of a network stream.
nlohmann::json stream_json(const PoseReport& report) {
  nlohmann::json out = to_json(report.faults);
  if (!report.stream) return out;
  out["packets"] = report.stream->packets;
  out["lost_pct"] = rounded(lost_pct(report), 3);
  out["delay_ms"] = rounded(1e3 * report.stream->delay_s);
  out["jitter_ms"] = rounded(1e3 * report.stream->jitter_s, 3);
  out["drift_ppm"] = rounded(report.stream->drift_ppm, 3);
  return out;
}

nlohmann::json to_json(const PoseReport& report) {
  nlohmann::json age_ms;  // null where no frame has a pose
  if (report.age_ms.count() > 0)
    age_ms = {{"p50", quantile(report.age_ms, 0.5)}, {"p95", quantile(report.age_ms, 0.95)}};
  nlohmann::json out = {
      {"source", report.source},
      {"frames", report.frames.frames[0]},
      {"lost", report.frames.lost()},
      {"lost_by", lost_by_reason(report.frames)},
      {"when_lost", report.when_lost == pose::WhenLost::kHide ? "hide" : "freeze"},
      {"jumps", report.frames.jumps},
      {"latency_s", report.latency_s},
      {"stream", stream_json(report)},
      {"age_ms", age_ms}};
  if (report.error && report.error->frames() > 0) out["error"] = report.error->to_json();
  const SlipReport& slip = report.slip;
  out["slip_px"] = slip.measured ? to_json(*slip.measured) : nlohmann::json();
  out["slip_sigma_px"] = or_null(slip.sigma_px);
  out["within_95_pct"] = or_null(slip.within_95_pct);
  return out;
}

nlohmann::json to_json(const LensReport& lens) {
  nlohmann::json out{{"changed", lens.changed},
                     {"beyond_background", lens.beyond_background},
                     {"fx_px", {rounded(lens.least_fx_px, 5), rounded(lens.most_fx_px, 5)}}};
  for (std::size_t i = 0; i < lens.frames.size(); ++i)
    out["frames"][std::string(capture::name(static_cast<capture::LensOrigin>(i)))] = lens.frames[i];
  return out;
}

std::string lens_line(const LensReport& lens) {
  const auto frames = [&](capture::LensOrigin origin) {
    return lens.frames[static_cast<std::size_t>(origin)];
  };
  return fmt::format(
      "  lens: fx {:.1f} to {:.1f} px, moved in {} frames; outside its table in {}, without value "
      "in {}, beyond what was learned of the room in {}\n",
      lens.least_fx_px, lens.most_fx_px, lens.changed, frames(capture::LensOrigin::kClamped),
      frames(capture::LensOrigin::kHeld), lens.beyond_background);
}

std::string slip_line(const SlipReport& slip) {
  std::string line;
  if (slip.measured)
    line = fmt::format("measured {:.2f} px RMS, at most {:.2f} px", slip.measured->rms_px,
                       slip.measured->max_px);
  if (slip.sigma_px)
    line += fmt::format("{}predicted {:.2f} px RMS", line.empty() ? "" : "; ", *slip.sigma_px);
  return line.empty() ? line : "  slip of the contact points: " + line + "\n";
}

/// Packets of a stream of poses that gave none, by reason.
std::string stream_line(const capture::PoseFaults& f) {
  const std::pair<std::uint64_t, const char*> counts[] = {
      {f.packets_lost, "lost"},
      {f.packets_late, "late"},
      {f.packets_bad, "damaged or of another layout"},
      {f.packets_version, "of another version"},
      {f.packets_foreign, "of another camera, source or sender"},
      {f.packets_unstamped, "without a time stamp"}};
  std::string line;
  for (const auto& [count, what] : counts)
    if (count > 0) line += fmt::format("{}{} {}", line.empty() ? "" : ", ", count, what);
  if (f.refused > 0)
    line += fmt::format("{}{} in which the camera's body is missing or not tracked",
                        line.empty() ? "" : ", ", f.refused);
  return "  pose packets: " + line + "\n";
}

/// Lines about poses; empty where all frames have sound poses and no slip or true pose is known.
std::string pose_line(const PoseReport& report) {
  const capture::PoseFaults& f = report.faults;
  std::string line;
  if (report.frames.lost() > 0) {
    const nlohmann::json reasons = lost_by_reason(report.frames);
    for (const auto& [why, count] : reasons.items())
      line += fmt::format("{}{} {}", line.empty() ? "" : ", ", why, count.get<std::uint64_t>());
    line = fmt::format("  pose lost in {} frames ({}): virtual objects {}\n", report.frames.lost(),
                       line, report.when_lost == pose::WhenLost::kHide ? "hidden" : "frozen");
  }
  if (report.frames.jumps + f.jumps + f.not_finite + f.clock_steps > 0)
    line += fmt::format(
        "  poses: jumps: {} between frames, {} in their stream; left out there: {} not finite; "
        "steps of their clock: {}\n",
        report.frames.jumps, f.jumps, f.not_finite, f.clock_steps);
  if (f.packets() + f.refused > 0) line += stream_line(f);
  if (report.error && report.error->frames() > 0)
    line += "  pose error against truth: " + report.error->to_line() + "\n";
  return line + slip_line(report.slip);
}

nlohmann::json to_json(const output::StreamOutReport& stream) {
  nlohmann::json out{{"uri", stream.uri},
                     {"picture", stream.picture},
                     {"size_px", {stream.size.width, stream.size.height}},
                     {"frames", stream.frames},
                     {"dropped", stream.dropped}};
  const auto& pair = stream.stereo;
  if (const std::uint64_t all = pair.seen + pair.behind + pair.guessed; all > 0)
    out["stereo"] = {
        {"behind_pct", 100.0 * static_cast<double>(pair.behind) / static_cast<double>(all)},
        {"guessed_pct", 100.0 * static_cast<double>(pair.guessed) / static_cast<double>(all)}};
  return out;
}

nlohmann::json to_json(const PlateReport& plates) {
  return {{"imported", plates.imported}, {"copied", plates.copied}, {"how", text(plates)}};
}

/// Adds counts and times of the frames; only stages that ran are listed.
void add_frames(const FrameReport& frames, nlohmann::json& out) {
  out["frames"] = frames.frame_ms.count();
  out["stage_ms"] = nlohmann::json::object();
  for (std::size_t i = 0; i < frames.stage_ms.size(); ++i) {
    const measure::QuantileSketch& times = frames.stage_ms[i];
    if (!ran(times)) continue;
    out["stage_ms"][std::string(render::name(static_cast<render::Stage>(i)))] = {
        {"p50", quantile(times, 0.5)}, {"p95", quantile(times, 0.95)}};
  }
  out["frame_ms"] = three_quantiles(frames.frame_ms);
  out["foreground_pct"] = {{"mean", rounded(frames.foreground_pct.mean())},
                           {"p50", quantile(frames.foreground_pct, 0.5)},
                           {"max", rounded(frames.foreground_pct.max())}};
}

nlohmann::json edits_json(const SceneEdits& edits, const measure::QuantileSketch& swap_ms) {
  nlohmann::json swaps;  // null where no compositor was exchanged
  if (swap_ms.count() > 0) swaps = {{"p50", quantile(swap_ms, 0.5)}, {"max", quantile(swap_ms, 1)}};
  return {{"taken", edits.taken}, {"refused", edits.refused}, {"swap_ms", swaps}};
}

void add_compositor(const CompositorReport& compositor, nlohmann::json& out) {
  out["backend"] = compositor.backend;
  out["renderer"] = compositor.renderer;
  out["size"] = text(compositor.size);
  if (compositor.plates) out["camera_pictures"] = to_json(*compositor.plates);
  if (compositor.light) out["light"] = to_json(*compositor.light);
  if (compositor.look) out["look"] = to_json(*compositor.look);
  if (compositor.room_changes) out["room_changes"] = to_json(*compositor.room_changes);
  if (compositor.scene_edits)
    out["scene_edits"] = edits_json(*compositor.scene_edits, compositor.swap_ms);
}

nlohmann::json live_json(const RunReport& report) {
  nlohmann::json out = report::to_json(*report.live);
  out["left_out"] = report.live->left_out;
  out["without_depth"] = report.live->without_depth;
  out["held_depth"] = report.live->held_depth;
  out["longest_gap_s"] = rounded(report.live->longest_gap_s, 3);
  out["before_ready"] = report.before_ready;
  out["latency_ms"] = three_quantiles(report.frames.latency_ms);
  return out;
}

std::string times_table(const FrameReport& frames) {
  std::string out = fmt::format("  {:<12} {:>8} {:>8}\n", "stage", "p50 ms", "p95 ms");
  const auto row = [&](std::string_view what, const measure::QuantileSketch& times) {
    out += fmt::format("  {:<12} {:>8.2f} {:>8.2f}\n", what, times.quantile(0.5),
                       times.quantile(0.95));
  };
  for (std::size_t i = 0; i < frames.stage_ms.size(); ++i)
    if (ran(frames.stage_ms[i]))
      row(render::name(static_cast<render::Stage>(i)), frames.stage_ms[i]);
  row("frame", frames.frame_ms);
  return out;
}

/// What the program has warned of, of the last lines of its log.
void add_warnings(nlohmann::json& out) {
  constexpr std::string_view kLevel = "warning ";
  for (const std::string& line : recent_log_lines())
    if (line.starts_with(kLevel)) out["warnings"].push_back(line.substr(kLevel.size()));
}

}  // namespace

std::string text(const PlateReport& plates) {
  if (plates.imported > 0) {
    std::string out = fmt::format("imported (DMABUF, {})", name(*plates.layout));
    const std::uint64_t all = plates.imported + plates.copied;
    if (plates.copied > 0) out += fmt::format(", {} of {} copied", plates.copied, all);
    return plates.why_copied.empty() ? out : out + ": " + plates.why_copied;
  }
  return "copied: " + (plates.why_copied.empty()
                           ? "the camera's driver shares no buffers of samples"
                           : plates.why_copied);
}

double fps(const RunReport& report) {
  const double mean_ms = report.frames.frame_ms.mean();
  return mean_ms > 0.0 ? 1e3 / mean_ms : 0.0;
}

nlohmann::json to_json(const RunReport& report) {
  nlohmann::json out;
  out["fps"] = rounded(fps(report));
  out["ended"] = report.ended;
  add_frames(report.frames, out);
  add_compositor(report.compositor, out);
  if (report.live) out["live"] = live_json(report);
  if (report.quality) out["quality"] = to_json(*report.quality);
  out["pose"] = to_json(report.pose);
  if (report.pose.lens) out["lens"] = to_json(*report.pose.lens);
  for (const auto& extra : report.extras) extra->add_to(out);
  for (const output::StreamOutReport& stream : report.stream_outs)
    out["stream_out"].push_back(to_json(stream));
  if (!report.sinks.empty()) out["sinks"] = nlohmann::json::array();
  for (const output::SinkReport& sink : report.sinks)
    out["sinks"].push_back(
        {{"name", sink.name}, {"written", sink.written}, {"dropped", sink.dropped}});
  out["rss_mb"] = rounded(report.rss_mb);
  if (report.error) out["error"] = to_json(*report.error);
  for (const BaselineErrors& b : report.baselines)
    out["baselines"][measure::name(b.baseline)] = to_json(b.errors);
  add_warnings(out);
  return out;
}

std::string to_table(const RunReport& report) {
  const CompositorReport& compositor = report.compositor;
  std::string out = fmt::format("{} frames, {}, {} ({})\n", report.frames.frame_ms.count(),
                                text(compositor.size), compositor.backend, compositor.renderer);
  out += times_table(report.frames);
  out += fmt::format("  {:.1f} fps, {:.0f} MB\n", fps(report), report.rss_mb);
  if (compositor.plates) out += "  camera pictures: " + text(*compositor.plates) + "\n";
  if (report.ended != "frames") out += "  ended: " + report.ended + "\n";
  if (report.live) out += live_line(*report.live);
  out += pose_line(report.pose);
  if (report.pose.lens) out += lens_line(*report.pose.lens);
  if (compositor.room_changes) out += to_lines(*compositor.room_changes);
  for (const auto& extra : report.extras) out += extra->lines();
  out += sink_lines(report.sinks);
  return report.error ? out + error_table(*report.error, report.baselines) : out;
}

double peak_rss_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string text_line; std::getline(status, text_line);)
    if (long kib = 0; std::sscanf(text_line.c_str(), "VmHWM: %ld kB", &kib) == 1)
      return static_cast<double>(kib) / 1024.0;
  return 0.0;
}

std::string text(Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace mixrig::session
