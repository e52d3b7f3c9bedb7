// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/scan_bench.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace mixrig::session {
namespace {

double scan_cpu_seconds() {
  timespec spent{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}

std::vector<ScanRung> scan_rungs(const RoomScanOptions& whole) {
  std::vector<ScanRung> rungs;
  const auto add = [&](const char* knob, const std::string& name, const auto& change) {
    RoomScanOptions options = whole;
    change(options);
    rungs.push_back({knob, name, options, 0, {}});
  };
  using Options = RoomScanOptions;
  add("steps", "all", [](Options&) {});
  add("steps", "no gains", [](Options& o) { o.panorama.equalise = false; });
  add("steps", "no alignment", [](Options& o) { o.align = false; });
  add("steps", "no planes", [](Options& o) { o.panorama.straighten = false; });
  add("steps", "no smoothing", [](Options& o) { o.panorama.smooth = false; });
  add("steps", "none", [](Options& o) {
    o.align = o.panorama.equalise = o.panorama.straighten = o.panorama.smooth = false;
  });
  for (const double mm : {0.5, 1.0, 2.0, 4.0})
    add("mesh", fmt::format("{:g} mm", mm), [&](Options& o) { o.mesh_tolerance_m = mm / 1000; });
  for (const int height : {360, 540, 720, 1080})
    add("panorama", fmt::format("{}x{}", 2 * height, height),
        [&](Options& o) { o.panorama.height_px = height; });
  return rungs;
}

double worst_mean_mm(const ScanRung& rung) {
  double worst = 0;
  for (const measure::WallToWall& axis : rung.scan.errors->axes)
    worst = std::max(worst, axis.mean_mm);
  return worst;
}

/// Frees what the plot and the table do not need, so that memory does not grow with the levels.
void drop_pictures(RoomScan& scan) {
  const std::size_t triangles = scan.mesh.indices.size();
  const model::ViewGains gains = scan.panorama.gains;
  scan.panorama = {};
  scan.panorama.gains = gains;
  scan.mesh = {};
  scan.mesh.indices.resize(triangles);
  scan.off_mm = {};
}

}  // namespace

Result<std::vector<ScanRung>> scan_bench(const ScanBenchOptions& options,
                                         const ProgressFn& progress) {
  RoomScanOptions whole;
  whole.take = options.take, whole.threads = options.threads, whole.evaluate = true;
  whole.calibration =
      options.calibration.empty() ? options.take / "truth/calibration.toml" : options.calibration;
  std::vector<ScanRung> rungs = scan_rungs(whole);
  int done = 0;
  for (ScanRung& rung : rungs) {
    const double before_s = scan_cpu_seconds();
    MIXRIG_ASSIGN(rung.scan, scan_room(rung.options));
    rung.cpu_seconds = scan_cpu_seconds() - before_s;
    drop_pictures(rung.scan);
    if (progress) progress("scan", ++done, static_cast<int>(rungs.size()));
  }
  return rungs;
}

nlohmann::json to_json(const std::vector<ScanRung>& rungs) {
  nlohmann::json out = nlohmann::json::array();
  for (const ScanRung& r : rungs) {
    nlohmann::json mean_mm = nlohmann::json::array(), max_mm = nlohmann::json::array();
    for (const measure::WallToWall& axis : r.scan.errors->axes)
      mean_mm.push_back(axis.mean_mm), max_mm.push_back(axis.max_mm);
    out.push_back({{"knob", r.knob},
                   {"rung", r.name},
                   {"cpu_seconds", r.cpu_seconds},
                   {"mean_mm", mean_mm},
                   {"max_mm", max_mm},
                   {"p50_mm", r.scan.errors->p50_mm},
                   {"p95_mm", r.scan.errors->p95_mm},
                   {"over_20mm_pct", r.scan.errors->over_20mm_pct},
                   {"color_pct", r.scan.panorama.gains.after_pct},
                   {"triangles", r.scan.mesh.indices.size() / 3},
                   {"mesh_mean_mm", r.scan.mesh_errors ? r.scan.mesh_errors->mean_mm : 0},
                   {"mesh_p95_mm", r.scan.mesh_errors ? r.scan.mesh_errors->p95_mm : 0}});
  }
  return {{"rungs", out}};
}

std::string to_table(const std::vector<ScanRung>& rungs) {
  std::string out = fmt::format(
      "{:<9} {:<13} {:>6} {:>13} {:>13} {:>13} {:>13} {:>7} {:>9} {:>13}\n", "knob", "level",
      "CPU s", "width", "depth", "height", "surface 50 95", "> 20 %", "triangles", "mesh mean 95");
  const auto pair = [](double a, double b) { return fmt::format("{:6.2f} {:6.2f}", a, b); };
  for (const ScanRung& r : rungs) {
    const measure::RoomErrors& e = *r.scan.errors;
    out += fmt::format("{:<9} {:<13} {:>6.2f}", r.knob, r.name, r.cpu_seconds);
    for (const measure::WallToWall& axis : e.axes) out += " " + pair(axis.mean_mm, axis.max_mm);
    out += fmt::format(" {} {:>7.2f} {:>9}", pair(e.p50_mm, e.p95_mm), e.over_20mm_pct,
                       r.scan.mesh.indices.size() / 3);
    out += r.scan.mesh_errors ? " " + pair(r.scan.mesh_errors->mean_mm, r.scan.mesh_errors->p95_mm)
                              : std::string();
    out += "\n";
  }
  return out;
}

report::Plot plot_of(const std::vector<ScanRung>& rungs) {
  report::Plot plot{"a scan: time against error",
                    "CPU seconds from the first frame to the mesh",
                    "error of the lengths, mean of the worst axis, mm",
                    {}};
  for (const ScanRung& rung : rungs) {
    if (rung.knob == "mesh" || rung.name == "no gains") continue;  // they do not move the panorama
    if (plot.series.empty() || plot.series.back().name != rung.knob)
      plot.series.push_back({rung.knob, {}});
    plot.series.back().points.push_back({rung.cpu_seconds, worst_mean_mm(rung), rung.name});
  }
  return plot;
}

}  // namespace mixrig::session
