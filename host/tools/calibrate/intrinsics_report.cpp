// SPDX-License-Identifier: Apache-2.0
#include "host/tools/calibrate/intrinsics_report.h"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace mixrig::tools {
namespace {

using calibration::Intrinsics;
using calibration::UncertaintyMap;

nlohmann::json numbers(const std::vector<double>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double v : values)
    list.push_back(std::isfinite(v) ? nlohmann::json(v) : nlohmann::json());
  return list;
}

constexpr double kDegree = M_PI / 180;

/// Field of view of a fisheye; null for a pinhole.
nlohmann::json field_of(const Intrinsics& in) {
  if (geometry::kind_of(in.camera) != geometry::LensKind::kFisheye) return {};
  nlohmann::json field{{"points_deg", in.point_angle_rad / kDegree},
                       {"largest_deg", nullptr},
                       {"ends_at_points", in.ends_at_points},
                       {"points_beyond", in.points_beyond},
                       {"circle", nullptr}};
  if (const auto angle = geometry::max_angle_rad(in.camera))
    field["largest_deg"] = *angle / kDegree;
  if (in.circle)
    field["circle"] = {{"center_px", {in.circle->center_px.x(), in.circle->center_px.y()}},
                       {"radius_px", in.circle->radius_px},
                       {"residual_px", in.circle->residual_px},
                       {"seen", in.circle->seen}};
  return field;
}

void print_field(const Intrinsics& in) {
  if (geometry::kind_of(in.camera) != geometry::LensKind::kFisheye) return;
  if (!in.circle)
    std::printf("image circle  none: the picture is taken to be filled\n");
  else
    std::printf("image circle  (%.1f, %.1f) px, radius %.1f px, %s; %d points beyond it\n",
                in.circle->center_px.x(), in.circle->center_px.y(), in.circle->radius_px,
                in.circle->seen > 0 ? fmt::format("found on {:.0f} % of its rim to {:.2f} px",
                                                  100 * in.circle->seen, in.circle->residual_px)
                                          .c_str()
                                    : "as given",
                in.points_beyond);
  const auto angle = geometry::max_angle_rad(in.camera);
  std::printf(
      "angles        points lie out to %.1f degrees from the axis; the lens is used out to %s"
      "\n",
      in.point_angle_rad / kDegree,
      angle ? fmt::format("{:.1f}{}", *angle / kDegree,
                          in.ends_at_points ? ", since it folds inside the picture: show "
                                              "the board nearer to the sides"
                                            : ", the rim of the image circle")
                  .c_str()
            : "the sides of the picture");
}

}  // namespace

std::vector<std::string> fit_objections(const Intrinsics& in, const UncertaintyMap& map) {
  constexpr double kWorst_px = 2.0, kMedian_px = 0.5, kRms_px = 1.0, kPointsOut = 0.1;
  std::vector<std::string> why;
  if (!(map.worst_px <= kWorst_px))
    why.push_back(fmt::format("a pixel is uncertain by {:.2f} px where it is worst", map.worst_px));
  if (!(map.median_px <= kMedian_px))
    why.push_back(fmt::format("the median pixel is uncertain by {:.2f} px", map.median_px));
  if (in.rms_px > kRms_px)
    why.push_back(
        fmt::format("points miss by {:.2f} px RMS (views of two cameras, a wrong --model or a soft "
                    "board?)",
                    in.rms_px));
  if (in.points_out > kPointsOut * (in.points + in.points_out))
    why.push_back(fmt::format("{:.0f} % of the points do not fit",
                              100.0 * in.points_out / (in.points + in.points_out)));
  return why;
}

std::vector<std::string> objections(const Intrinsics& in, const UncertaintyMap& map) {
  constexpr int kFewViews = 6;
  // So far beyond the outermost point, lenses of two and of four terms that fit the points equally
  // well still agree.
  constexpr double kMostBeyond_rad = 15 * kDegree;
  std::vector<std::string> why = fit_objections(in, map);
  if (const auto angle = geometry::max_angle_rad(in.camera);
      angle && *angle - in.point_angle_rad > kMostBeyond_rad)
    why.push_back(fmt::format(
        "the board was shown out to {:.0f} degrees from the axis and the image ends at {:.0f}: the "
        "lens is less certain there than stated: show it nearer to the rim",
        in.point_angle_rad / kDegree, *angle / kDegree));
  if (in.ends_at_points)
    why.push_back(fmt::format(
        "the lens folds inside the picture and is not known beyond {:.0f} degrees from its axis: "
        "show the board nearer to the sides, or give the --image-circle",
        geometry::max_angle_rad(in.camera).value_or(0) / kDegree));
  if (in.bundle.views.size() < kFewViews)
    why.push_back(fmt::format("only {} views", in.bundle.views.size()));
  return why;
}

nlohmann::json report_of(const std::string& camera, const BoardViews& all, const Intrinsics& in,
                         const UncertaintyMap& map, const calibration::Advice& advice,
                         const std::vector<std::string>& why) {
  const auto kind = geometry::kind_of(in.camera);
  const Eigen::VectorXd values = geometry::parameters_of(in.camera);
  nlohmann::json parameters, views = nlohmann::json::array();
  const auto names = geometry::parameter_names(kind);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    parameters[std::string(names[i])] = {{"value", values[k]},
                                         {"sigma", std::sqrt(in.covariance(k, k))}};
  }
  for (const auto& view : in.views)
    views.push_back({{"name", view.name},
                     {"used", view.used},
                     {"why_not", view.why_not},
                     {"rms_px", view.rms_px},
                     {"points", view.points},
                     {"points_out", view.points_out}});
  for (const auto& name : all.without)
    views.push_back({{"name", name}, {"used", false}, {"why_not", "the board was not found"}});
  return {{"camera", camera},
          {"model", name_of(kind)},
          {"lens_terms", in.lens_terms},
          {"size_px", {all.size_px.width, all.size_px.height}},
          {"older_layout", all.older_layout},
          {"parameters", parameters},
          {"rms_px", in.rms_px},
          {"sigma_px", in.sigma_px},
          {"held_out_px", in.held_out_px},
          {"points", in.points},
          {"points_out", in.points_out},
          {"field", field_of(in)},
          {"views", views},
          {"uncertainty",
           {{"columns", map.columns},
            {"rows", map.rows},
            {"sigma_px", numbers(map.sigma_px)},
            {"median_px", map.median_px},
            {"rim_px", map.rim_px},
            {"worst_px", map.worst_px}}},
          {"coverage", calibration::coverage(in, map.columns, map.rows)},
          {"advice",
           {{"where", advice.where},
            {"mean_now_px", advice.mean_now_px},
            {"mean_then_px", advice.mean_then_px}}},
          {"verdict", why.empty() ? "go" : "no-go"},
          {"why", why}};
}

void print(const std::string& camera, const BoardViews& all, const Intrinsics& in,
           const UncertaintyMap& map, const calibration::Advice& advice,
           const std::vector<std::string>& why) {
  const auto names = geometry::parameter_names(geometry::kind_of(in.camera));
  const Eigen::VectorXd values = geometry::parameters_of(in.camera);
  if (all.older_layout)
    std::printf("board         in OpenCV's layout before 4.6: the top left square is white\n");
  std::printf("camera        %s, %s, %dx%d, %d lens terms\n", camera.c_str(),
              std::string(name_of(geometry::kind_of(in.camera))).c_str(), all.size_px.width,
              all.size_px.height, in.lens_terms);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (in.covariance(k, k) > 0)
      std::printf("  %-4s %14.6g  +- %.3g\n", std::string(names[i]).c_str(), values[k],
                  std::sqrt(in.covariance(k, k)));
  }
  print_field(in);
  std::printf(
      "residual      %.4f px RMS over %d points of %zu views (%d points left out); held out %.4f "
      "px\n",
      in.rms_px, in.points, in.bundle.views.size(), in.points_out, in.held_out_px);
  for (const auto& view : in.views) {
    if (view.used)
      std::printf("  %-24s %.4f px, %d points\n", view.name.c_str(), view.rms_px, view.points);
    else
      std::printf("  %-24s left out: %s\n", view.name.c_str(), view.why_not.c_str());
  }
  for (const auto& name : all.without)
    std::printf("  %-24s left out: the board was not found\n", name.c_str());
  std::printf("uncertainty   of projection: median %.4f px, worst %.4f px\n", map.median_px,
              map.worst_px);
  if (advice.mean_then_px < 0.9 * advice.mean_now_px)
    std::printf("next view     hold the board %s: %.4f px would become %.4f px\n",
                advice.where.c_str(), advice.mean_now_px, advice.mean_then_px);
  else
    std::printf("next view     no single view would help much\n");
  std::string reasons;
  for (const auto& reason : why) reasons += (reasons.empty() ? ": " : "; ") + reason;
  std::printf("verdict       %s%s\n", why.empty() ? "go" : "no-go", reasons.c_str());
}

}  // namespace mixrig::tools
