// SPDX-License-Identifier: Apache-2.0
#include "host/app/report.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <utility>

#include "host/measure/percentile.h"

namespace mixrig::app {
namespace {

using NamedError = std::pair<const char*, std::optional<double>>;

std::array<NamedError, 9> named(const measure::Errors& e) {
  return {{{"depth_mae_mm", e.depth_mae_mm},
           {"depth_bad_pct", e.depth_bad_pct},
           {"band_bad_pct", e.band_bad_pct},
           {"key_iou", e.key_iou},
           {"matte_mse", e.matte_mse},
           {"order_wrong_pct", e.order_wrong_pct},
           {"light_rmse", e.light_rmse},
           {"light_shadow_rmse", e.light_shadow_rmse},
           {"color_psnr_db", e.color_psnr_db}}};
}

/// Four significant digits are more than any of these numbers carries.
double rounded(double value) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10.0, 3 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

bool ran(const std::vector<float>& times_ms) {
  for (float t : times_ms)
    if (t > 0.0F) return true;
  return false;
}

template <typename... Values>
std::string line(const char* format, Values... values) {
  char out[160];
  std::snprintf(out, sizeof out, format, values...);
  return out;
}

std::string live_line(const nlohmann::json& live) {
  const auto count = [&](const char* key) { return live.value(key, std::uint64_t{0}); };
  return line("  live: %llu moments, %llu dropped, %llu without colour or depth\n",
              static_cast<unsigned long long>(count("sets")),
              static_cast<unsigned long long>(count("dropped_sets")),
              static_cast<unsigned long long>(count("left_out")));
}

}  // namespace

double fps(const RunReport& report) {
  const double mean_ms = measure::mean(report.frame_ms);
  return mean_ms > 0.0 ? 1e3 / mean_ms : 0.0;
}

nlohmann::json to_json(const measure::Errors& errors) {
  nlohmann::json out = nlohmann::json::object();
  for (const auto& [key, value] : named(errors)) {
    if (value)
      out[key] = rounded(*value);
    else
      out[key] = nullptr;
  }
  return out;
}

nlohmann::json to_json(const RunReport& report) {
  nlohmann::json out;
  out["frames"] = report.frame_ms.size();
  out["fps"] = rounded(fps(report));
  out["backend"] = report.backend;
  out["renderer"] = report.renderer;
  out["size"] = text(report.size);
  out["ended"] = report.ended;
  if (!report.live.is_null()) out["live"] = report.live;
  out["stage_ms"] = nlohmann::json::object();
  for (std::size_t i = 0; i < report.stage_ms.size(); ++i) {
    const std::vector<float>& times = report.stage_ms[i];
    if (!ran(times)) continue;
    out["stage_ms"][std::string(render::name(static_cast<render::Stage>(i)))] = {
        {"p50", rounded(measure::quantile(times, 0.5))},
        {"p95", rounded(measure::quantile(times, 0.95))}};
  }
  out["frame_ms"] = {{"p50", rounded(measure::quantile(report.frame_ms, 0.5))},
                     {"p95", rounded(measure::quantile(report.frame_ms, 0.95))},
                     {"p99", rounded(measure::quantile(report.frame_ms, 0.99))}};
  out["rss_mb"] = rounded(report.rss_mb);
  out["foreground_pct"] = nlohmann::json::array();
  for (double share : report.foreground_pct) out["foreground_pct"].push_back(rounded(share));
  if (report.error) out["error"] = to_json(*report.error);
  return out;
}

std::string to_table(const RunReport& report) {
  std::string out =
      line("%zu frames, %s, %s (%s)\n", report.frame_ms.size(), text(report.size).c_str(),
           report.backend.c_str(), report.renderer.c_str());
  out += line("  %-12s %8s %8s\n", "stage", "p50 ms", "p95 ms");
  const auto row = [&](const std::string& what, const std::vector<float>& times) {
    out += line("  %-12s %8.2f %8.2f\n", what.c_str(), measure::quantile(times, 0.5),
                measure::quantile(times, 0.95));
  };
  for (std::size_t i = 0; i < report.stage_ms.size(); ++i)
    if (ran(report.stage_ms[i]))
      row(std::string(render::name(static_cast<render::Stage>(i))), report.stage_ms[i]);
  row("frame", report.frame_ms);
  out += line("  %.1f fps, %.0f MB\n", fps(report), report.rss_mb);
  if (report.ended != "frames") out += "  ended: " + report.ended + "\n";
  if (!report.live.is_null()) out += live_line(report.live);
  if (!report.error) return out;
  out += "  error against truth\n";
  for (const auto& [key, value] : named(*report.error))
    out += value ? line("  %-18s %10.4g\n", key, *value) : line("  %-18s %10s\n", key, "-");
  return out;
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

}  // namespace mixrig::app
