// SPDX-License-Identifier: Apache-2.0
#include "host/tools/info_depth.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hal/base/order_statistics.h"
#include "hal/base/percentile.h"
#include "host/capture/depth/depth_figures.h"
#include "host/output/sheet/contact_sheet.h"

namespace mixrig::tools {
namespace {

constexpr int kMostPictures = 40;
constexpr double kNearlySquare_deg = 10;

/// Median and quartiles of values that are known, in millimetres.
struct Spread {
  std::size_t count = 0;
  double median_mm = 0, low_mm = 0, high_mm = 0;

  std::string text() const {
    return count == 0 ? "unknown"
                      : fmt::format("{:.1f} mm ({:.1f} to {:.1f})", median_mm, low_mm, high_mm);
  }
  nlohmann::json json() const {
    if (count == 0) return nullptr;
    return {{"count", count}, {"median", median_mm}, {"quartiles", {low_mm, high_mm}}};
  }
};

Spread spread_of(const std::vector<double>& values_m) {
  std::vector<float> mm;
  for (const double v : values_m)
    if (!std::isnan(v)) mm.push_back(static_cast<float>(1e3 * v));
  return {mm.size(), measure::quantile(mm, 0.5), measure::quantile(mm, 0.25),
          measure::quantile(mm, 0.75)};
}

nlohmann::json noise_json(const depth::DepthFigures& figures) {
  std::printf("  noise      %-12s %9s %11s %12s %10s\n", "depth, m", "cells", "spatial, mm",
              "temporal, mm", "amplitude");
  nlohmann::json rows = nlohmann::json::array();
  for (const depth::NoiseRow& row : figures.noise) {
    const std::string temporal =
        row.temporal_m > 0 ? fmt::format("{:.1f}", 1e3 * row.temporal_m) : "-";
    std::printf("             %-12s %9zu %11.1f %12s %10.0f\n",
                fmt::format("{:g} to {:g}", row.from_m, row.to_m).c_str(), row.cells,
                1e3 * row.spatial_m, temporal.c_str(), row.amplitude);
    rows.push_back({{"from_m", row.from_m},
                    {"to_m", row.to_m},
                    {"cells", row.cells},
                    {"spatial_mm", 1e3 * row.spatial_m},
                    {"temporal_mm", 1e3 * row.temporal_m},
                    {"amplitude", row.amplitude}});
  }
  return rows;
}

nlohmann::json planes_json(const depth::DepthFigures& figures) {
  std::vector<double> rms_m, bend_m, distance_m, area_m2;
  for (const depth::Flatness& plane : figures.planes) {
    rms_m.push_back(plane.rms_m), bend_m.push_back(plane.bend_m);
    distance_m.push_back(plane.distance_m), area_m2.push_back(plane.area_m2);
  }
  const Spread rms = spread_of(rms_m), bend = spread_of(bend_m);
  const double away_m = median_in_place(std::span(distance_m)),
               area = median_in_place(std::span(area_m2));
  std::printf(
      "  planes     %zu, median (quartiles): %.1f m away, %.1f m2; off flat %s rms, bent %s\n",
      rms.count, away_m, area, rms.text().c_str(), bend.text().c_str());
  return {{"count", rms.count},
          {"distance_m", away_m},
          {"area_m2", area},
          {"rms_mm", rms.json()},
          {"bend_mm", bend.json()}};
}

nlohmann::json corners_json(const depth::DepthFigures& figures) {
  std::vector<double> off_square, distance_m;
  for (const depth::SeenCorner& corner : figures.corners) {
    const double off_deg = std::abs(corner.angle_deg - 90);
    if (off_deg < kNearlySquare_deg) off_square.push_back(off_deg);
    distance_m.push_back(corner.distance_m);
  }
  const double off_deg = median_in_place(std::span(off_square)),
               away_m = median_in_place(std::span(distance_m));
  std::printf("  corners    %zu, median: %.1f m away, %.1f degrees off square\n",
              figures.corners.size(), away_m, off_deg);
  nlohmann::json bands = nlohmann::json::array();
  for (std::size_t i = 0; i < depth::kCornerBands; ++i) {
    std::vector<double> errors_m;
    for (const depth::SeenCorner& corner : figures.corners) errors_m.push_back(corner.error_m[i]);
    const Spread error = spread_of(errors_m);
    const double from_mm = 1e3 * depth::kCornerLimits_m[i],
                 to_mm = 1e3 * depth::kCornerLimits_m[i + 1];
    std::printf("             %3.0f to %3.0f mm from the corner: %s\n", from_mm, to_mm,
                error.text().c_str());
    bands.push_back({{"from_mm", from_mm}, {"to_mm", to_mm}, {"error_mm", error.json()}});
  }
  return {{"count", figures.corners.size()},
          {"distance_m", away_m},
          {"off_square_deg", off_deg},
          {"bands", bands}};
}

}  // namespace

Result<nlohmann::json> info_depth(capture::CaptureSource& source) {
  depth::DepthMeter meter(source.info().tof);
  capture::Capture frame, next;
  for (const int number : output::spread(1, source.info().frames, kMostPictures)) {
    MIXRIG_TRY(source.read(number, frame));
    if (frame.depth_m.empty()) continue;
    next.depth_m.reset({});
    if (number < source.info().frames) {
      MIXRIG_TRY(source.read(number + 1, next));
    }
    if (source.info().depth_kind == capture::DepthKind::kDistance)
      meter.rays().to_depth(frame.depth_m), meter.rays().to_depth(next.depth_m);
    meter.add(frame.depth_m, frame.amplitude, next.depth_m);
  }
  const depth::DepthFigures figures = meter.figures();
  if (figures.pictures == 0)
    return Error{ErrorCode::kData, "'" + source.info().name +
                                       "' has no depth picture: --depth describes depth alone"};
  std::printf("depth camera, %zu pictures, %.1f %% of the pixels unknown%s\n", figures.pictures,
              100 * figures.unknown_share,
              figures.moves ? "; it moves: temporal noise is not measured" : "");
  nlohmann::json report = {{"pictures", figures.pictures},
                           {"unknown_pct", 100 * figures.unknown_share},
                           {"moves", figures.moves}};
  report["noise"] = noise_json(figures);
  report["planes"] = planes_json(figures);
  report["corners"] = corners_json(figures);
  std::printf("  steps      %zu, of three pixels across one %.2f fly and %.2f are unknown\n",
              figures.steps, figures.flying_pixels, figures.unknown_pixels);
  report["steps"] = {{"count", figures.steps},
                     {"flying_px", figures.flying_pixels},
                     {"unknown_px", figures.unknown_pixels}};
  return report;
}

}  // namespace mixrig::tools
