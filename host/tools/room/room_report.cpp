// SPDX-License-Identifier: Apache-2.0
#include "host/tools/room/room_report.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "hal/base/angles.h"
#include "host/run/report/run_report.h"

namespace mixrig::tools {
namespace {

/// How well views agree where they overlap, as the unit or the poses say.
nlohmann::json agreement_json(const model::Alignment& a) {
  std::printf("overlaps: median %.1f mm, 95 %% within %.1f mm, %d places\n", 1e3 * a.median_m,
              1e3 * a.p95_m, a.samples);
  if (a.refused)
    std::printf(
        "views would agree if half of them were turned by %.1f deg and more, which no unit errs "
        "by: the depth is wrong, by light that comes by way of other surfaces or by its "
        "calibration; no view was turned\n",
        a.median_turn_rad / kDeg);
  return {{"median_mm", 1e3 * a.median_m},
          {"p95_mm", 1e3 * a.p95_m},
          {"places", a.samples},
          {"turns_refused", a.refused}};
}

/// Differences in brightness of the views' pictures, before and after correction.
nlohmann::json gains_json(const model::ViewGains& g) {
  double most = 1;
  for (const Eigen::Array3f& gain : g.gains)
    most = std::max<double>(most, std::max(gain.maxCoeff(), 1 / gain.minCoeff()));
  const double corner_pct = 100 * (1 - 1 / g.vignetting.factor(1));
  if (!g.gains.empty())
    std::printf(
        "colours of overlapping views differed by %.1f %%, %.1f %% with gains (up to a factor of "
        "%.2f) and a lens that darkens corners by %.0f %%\n",
        g.before_pct, g.after_pct, most, corner_pct);
  return {{"places", g.samples},
          {"before_pct", g.before_pct},
          {"after_pct", g.after_pct},
          {"largest_factor", most},
          {"corners_pct", corner_pct}};
}

/// Each fault in a line of its own, saturated views in one: most rooms have lamps.
nlohmann::json findings_json(const std::vector<model::Finding>& findings) {
  nlohmann::json list = nlohmann::json::array();
  std::string saturated;
  double most_pct = 0;
  for (const model::Finding& f : findings) {
    if (f.kind == model::FindingKind::kSaturatedView)
      saturated += (saturated.empty() ? "" : ", ") + std::to_string(f.view),
          most_pct = std::max(most_pct, f.value);
    else
      std::printf("%s\n", model::text_of(f).c_str());
    list.push_back({{"kind", model::name(f.kind)},
                    {"view", f.view},
                    {"azimuth_deg", f.azimuth_deg},
                    {"elevation_deg", f.elevation_deg},
                    {"value", f.value}});
  }
  if (!saturated.empty())
    std::printf(
        "saturated colour (lamps, windows) in views %s, up to %.1f %% of a picture: a shorter "
        "exposure would show what is bright\n",
        saturated.c_str(), most_pct);
  return list;
}

nlohmann::json bounced_json(const session::BouncedRoomLight& b) {
  if (b.removed)
    std::printf(
        "light between walls taken out: the room reflects %.2f in the infrared; beside %zu corners "
        "the depth was off by %.1f mm, now by %.1f mm\n",
        b.reflectivity, b.corners, b.before_mm, b.after_mm);
  else
    std::printf(
        "light between walls left in: %zu corners between walls show none, or are too few\n",
        b.corners);
  return {{"removed", b.removed},
          {"reflectivity", b.reflectivity},
          {"corners", b.corners},
          {"before_mm", b.before_mm},
          {"after_mm", b.after_mm}};
}

nlohmann::json reach_json(const session::DepthReach& reach) {
  constexpr double kWorthALine_pct = 5;
  if (reach.beyond_pct > kWorthALine_pct)
    std::printf(
        "%.0f %% of the room is farther than %.1f m, the farthest board of the depth camera's "
        "calibration: its depth error there is taken to be the same\n",
        reach.beyond_pct, reach.far_m);
  return {{"far_m", reach.far_m}, {"beyond_pct", reach.beyond_pct}};
}

/// Result of the plates at other exposures.
nlohmann::json bracket_json(const std::vector<model::FoundExposure>& exposures) {
  nlohmann::json list = nlohmann::json::array();
  for (const model::FoundExposure& e : exposures) {
    list.push_back({{"nominal", e.nominal},
                    {"measured", e.measured},
                    {"views", e.views},
                    {"samples", e.samples},
                    {"used", e.used}});
    if (e.nominal == 1) continue;
    std::printf("exposure %.4g of the plates' in %d views: %.4g by the pictures%s\n", e.nominal,
                e.views, e.measured,
                !e.used          ? ": not what the camera says, not used"
                : e.samples == 0 ? " (too few pixels: as the others let expect)"
                                 : "");
  }
  return list;
}

nlohmann::json light_error_json(const char* what, const measure::LightError& e) {
  std::printf(
      "light of %s: error median %.1f %%, 95 %% within %.1f %%, bias %+.1f %%, %.1f %% saturated, "
      "%zu places\n",
      what, e.p50_pct, e.p95_pct, e.bias_pct, e.saturated_pct, e.places);
  return {{"places", e.places},
          {"p50_pct", e.p50_pct},
          {"p95_pct", e.p95_pct},
          {"bias_pct", e.bias_pct},
          {"saturated_pct", e.saturated_pct}};
}

nlohmann::json mesh_json(const measure::MeshErrors& errors) {
  std::printf(
      "mesh: added error mean %.2f mm, 95 %% within %.2f mm, largest %.0f mm, %.2f %% not "
      "covered\n",
      errors.mean_mm, errors.p95_mm, errors.max_mm, errors.uncovered_pct);
  return {{"mean_mm", errors.mean_mm},
          {"p95_mm", errors.p95_mm},
          {"max_mm", errors.max_mm},
          {"uncovered_pct", errors.uncovered_pct}};
}

}  // namespace

nlohmann::json errors_json(const measure::RoomErrors& errors) {
  nlohmann::json mean_mm, max_mm, p95_mm, count;
  constexpr std::array<const char*, 3> kAxes{"width", "depth", "height"};
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const measure::WallToWall& axis = errors.axes[i];
    mean_mm[kAxes[i]] = axis.mean_mm;
    p95_mm[kAxes[i]] = axis.p95_mm;
    max_mm[kAxes[i]] = axis.max_mm;
    count[kAxes[i]] = axis.count;
    std::printf("%-6s %3d lengths: error mean %5.1f mm, 95 %% within %5.1f mm, largest %5.1f mm\n",
                kAxes[i], axis.count, axis.mean_mm, axis.p95_mm, axis.max_mm);
  }
  std::printf("surface: median %.1f mm, 95 %% within %.1f mm, %.2f %% over 20 mm\n", errors.p50_mm,
              errors.p95_mm, errors.over_20mm_pct);
  return {{"mean_mm", mean_mm},
          {"p95_mm", p95_mm},
          {"max_mm", max_mm},
          {"lengths", count},
          {"surface",
           {{"p50_mm", errors.p50_mm},
            {"p95_mm", errors.p95_mm},
            {"over_20mm_pct", errors.over_20mm_pct}}}};
}

nlohmann::json room_report(const session::RoomScan& room, double write_seconds) {
  const model::Panorama& p = room.panorama;
  std::printf("%d views, %d frames: %.2f %% of the field measured, %.2f %% known\n", room.views,
              room.frames, 100 * p.measured_share, 100 * p.known_share);
  const std::size_t triangles = room.mesh.indices.size() / 3;
  std::printf("%zu triangles of %zu, to %.2f mm\n", triangles, room.triangles_raw,
              1000 * room.tolerance_m);
  std::printf(
      "%.2f s to read and average, %.2f s for the panorama, %.2f s for the mesh, %.2f s to write\n",
      room.read_seconds, room.model_seconds, room.mesh_seconds, write_seconds);
  nlohmann::json report = {
      {"views", room.views},
      {"frames", room.frames},
      {"seconds", room.read_seconds + room.model_seconds + room.mesh_seconds + write_seconds},
      {"model_seconds", room.model_seconds},
      {"align_seconds", room.align_seconds},
      {"mesh_seconds", room.mesh_seconds},
      {"write_seconds", write_seconds},
      {"triangles_raw", room.triangles_raw},
      {"triangles", triangles},
      {"rss_mb", session::peak_rss_mb()},
      {"measured_pct", 100 * p.measured_share},
      {"fill_pct", 100 * p.known_share},
      {"planes", p.planes.size()},
      {"overlaps", agreement_json(room.alignment)},
      {"gains", gains_json(p.gains)},
      {"findings", findings_json(room.findings)}};
  if (!room.exposures.empty()) report["bracket"] = bracket_json(room.exposures);
  if (room.bounced) report["bounced_light"] = bounced_json(*room.bounced);
  if (room.depth_reach) report["depth_reach"] = reach_json(*room.depth_reach);
  if (room.errors) report["evaluate"] = errors_json(*room.errors);
  if (room.light_errors)
    report["evaluate"]["light"] = {
        {"lamps", light_error_json("lamps", room.light_errors->lamps)},
        {"bright", light_error_json("bright surfaces", room.light_errors->bright)},
        {"dim", light_error_json("dim surfaces", room.light_errors->dim)}};
  if (room.mesh_errors) report["evaluate"]["mesh"] = mesh_json(*room.mesh_errors);
  return report;
}

}  // namespace mixrig::tools
