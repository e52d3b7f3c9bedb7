// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/bench.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/log.h"
#include "host/run/loop/run.h"
#include "studio/io/studio_take.h"

namespace mixrig::session {
namespace {

using studio::RigPreset;

Size full_size(const BenchOptions& options) {
  return options.quick ? Size{640, 512} : Size{1280, 1024};
}

std::vector<Rung> rungs_of(const BenchOptions& options) {
  const Size full = full_size(options);
  const auto part = [&](int quarters) {
    return Size{full.width * quarters / 4, full.height * quarters / 4};
  };
  const auto rung = [](const char* knob, const std::string& name, RigPreset rig,
                       render::Backend backend, int threads, Size size) {
    return Rung{knob, name, rig, {backend, threads}, size, {}};
  };
  constexpr RigPreset kRig = RigPreset::kKinect2;
  std::vector<Rung> rungs;
  for (int threads : {1, 2})
    rungs.push_back(rung(
        "back end", "cpu, " + std::to_string(threads) + (threads == 1 ? " thread" : " threads"),
        kRig, render::Backend::kCpu, threads, full));
  rungs.push_back(rung("back end", "gles", kRig, render::Backend::kGles, 0, full));
  for (RigPreset rig : {RigPreset::kSr3000, RigPreset::kKinect2, RigPreset::kHelios2})
    rungs.push_back(
        rung("depth camera", std::string(studio::name(rig)), rig, render::Backend::kCpu, 2, full));
  for (int quarters : {2, 3, 4})
    rungs.push_back(
        rung("view size", text(part(quarters)), kRig, render::Backend::kCpu, 2, part(quarters)));
  return rungs;
}

bool same_setting(const Rung& a, const Rung& b) {
  return a.rig == b.rig && a.backend.backend == b.backend.backend &&
         a.backend.threads == b.backend.threads && a.view_size == b.view_size;
}

Result<RunReport> run_rung(const Rung& rung, const BenchOptions& options, const Clock& clock,
                           const ProgressFn& progress) {
  MIXRIG_ASSIGN(const std::filesystem::path take, bench_take(options, rung.rig, progress));
  MIXRIG_ASSIGN(const auto session, open_session({take / "scene.toml", "take:" + take.string(),
                                                  rung.view_size, rung.backend}));
  RunOptions run_options;
  run_options.baselines = true;
  return run(*session, run_options, clock, progress);
}

std::string cell(const std::optional<double>& value, int width, int digits) {
  return value ? fmt::format(" {:>{}.{}f}", *value, width, digits)
               : fmt::format(" {:>{}}", "-", width);
}

/// The rest of a row of the table.
std::string error_columns(const measure::Errors& e) {
  return cell(e.depth_bad_pct, 9, 2) + cell(e.key_iou, 8, 4) + cell(e.order_wrong_pct, 8, 2) +
         cell(e.light_shadow_rmse, 8, 4) + cell(e.object_rmse, 8, 4) + cell(e.color_psnr_db, 8, 1) +
         cell(e.contested.key_iou, 18, 4) + cell(e.contested.color_psnr_db, 8, 1) + "\n";
}

/// Wrong share of the union of true and found person.
double key_wrong_pct(const Rung& rung) {
  return 100.0 * (1.0 - rung.report.error->key_iou.value_or(0.0));
}

/// The median shows the steady state of a rung; the slow first frame affects only p95.
double p50_ms(const Rung& rung) { return rung.report.frames.frame_ms.quantile(0.5); }

}  // namespace

Result<std::filesystem::path> bench_take(const BenchOptions& options, RigPreset rig,
                                         const ProgressFn& progress) {
  studio::StudioOptions wanted;
  wanted.scenario = studio::Scenario::kWalk;
  wanted.rig = rig;
  wanted.seed = options.seed;
  wanted.frames = options.quick ? 24 : 48;
  wanted.size_px = full_size(options);
  const std::filesystem::path folder =
      options.folder / "takes" /
      ("walk" + std::to_string(wanted.seed) + "-" + std::string(studio::name(rig)) + "-" +
       text(wanted.size_px) + "-" + std::to_string(wanted.frames));
  std::error_code code;
  if (std::filesystem::exists(folder / "take.toml", code)) return folder;
  const auto step = [&](int done) {
    if (progress) progress("studio", done, wanted.frames);
  };
  const auto written = studio_io::write_studio_take(wanted, folder, take::StreamFormat::kPng, step);
  if (!written) return written.error();
  return folder;
}

Result<std::vector<Rung>> bench(const BenchOptions& options, const Clock& clock,
                                const ProgressFn& progress) {
  std::vector<Rung> done;
  for (Rung& rung : rungs_of(options)) {
    const auto same = std::find_if(done.begin(), done.end(),
                                   [&](const Rung& other) { return same_setting(other, rung); });
    if (same != done.end()) {
      rung.report = same->report;
    } else {
      auto report = run_rung(rung, options, clock, progress);
      if (!report && rung.backend.backend == render::Backend::kGles) {
        log_warning("bench", "left out gles: " + to_line(report.error()));
        continue;
      }
      MIXRIG_ASSIGN(rung.report, std::move(report));
    }
    done.push_back(std::move(rung));
  }
  return done;
}

nlohmann::json to_json(const std::vector<Rung>& rungs) {
  nlohmann::json out = nlohmann::json::array();
  for (const Rung& rung : rungs)
    out.push_back({{"knob", rung.knob},
                   {"rung", rung.name},
                   {"p50_ms", p50_ms(rung)},
                   {"report", to_json(rung.report)}});
  return {{"rungs", out}};
}

std::string to_table(const std::vector<Rung>& rungs) {
  std::string out = fmt::format(
      "{:<13} {:<15} {:>8} {:>8} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8} | contested {:>6} {:>8}\n",
      "knob", "level", "p50 ms", "p95 ms", "depth bad", "key iou", "order", "shadow", "object",
      "PSNR dB", "iou", "PSNR dB");
  for (const Rung& rung : rungs) {
    out += fmt::format("{:<13} {:<15} {:>8.1f} {:>8.1f}", rung.knob, rung.name, p50_ms(rung),
                       rung.report.frames.frame_ms.quantile(0.95));
    out += error_columns(*rung.report.error);
    if (rung.knob != "depth camera") continue;
    for (const BaselineErrors& b : rung.report.baselines)
      out += fmt::format("{:<13} {:<15} {:>8} {:>8}", "", measure::name(b.baseline), "", "") +
             error_columns(b.errors);
  }
  return out;
}

report::Plot plot_of(const std::vector<Rung>& rungs) {
  report::Plot plot{"speed against error",
                    "milliseconds a frame (median)",
                    "wrongly keyed, % of the person (1 - key_iou)",
                    {}};
  for (const Rung& rung : rungs) {
    if (plot.series.empty() || plot.series.back().name != rung.knob)
      plot.series.push_back({rung.knob, {}});
    plot.series.back().points.push_back({p50_ms(rung), key_wrong_pct(rung), rung.name});
  }
  return plot;
}

}  // namespace mixrig::session
