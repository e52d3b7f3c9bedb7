// SPDX-License-Identifier: Apache-2.0
#include "extras/map/learn/path_errors.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/percentile.h"
#include "host/math/estimation/points/rigid_fit.h"

namespace mixrig::session {
namespace {

double root_mean_square(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += static_cast<double>(v) * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Slope of the values over their index, by least squares.
double slope_by_number(const std::vector<float>& values) {
  const double middle = 0.5 * static_cast<double>(values.size() - 1);
  double xx = 0, xy = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    xx += x * x, xy += x * values[i];
  }
  return xx > 0 ? xy / xx : 0;
}

std::optional<estimation::Similarity> laid_on(std::span<const PosePair> pairs, bool free_scale) {
  std::vector<Eigen::Vector3d> found, truth;
  for (const PosePair& p : pairs)
    found.push_back(p.found.translation_m), truth.push_back(p.truth.translation_m);
  if (free_scale) {
    const auto fit = estimation::similarity_fit(found, truth);
    return fit.usable() ? std::optional(fit.value) : std::nullopt;
  }
  const auto fit = estimation::rigid_fit(found, truth);
  if (!fit.usable()) return std::nullopt;
  return estimation::Similarity{1, fit.value};
}

}  // namespace

nlohmann::json errors_of_path(std::span<const PosePair> pairs, bool free_scale) {
  const auto on_truth = laid_on(pairs, free_scale);
  if (!on_truth) return nullptr;
  std::vector<float> shift_mm, turn_deg;
  double extent_m = 0;
  for (const PosePair& p : pairs) {
    const Eigen::Vector3d off = *on_truth * p.found.translation_m - p.truth.translation_m;
    shift_mm.push_back(static_cast<float>(1e3 * off.norm()));
    turn_deg.push_back(static_cast<float>(
        p.truth.rotation.angularDistance(on_truth->pose.rotation * p.found.rotation) / kDeg));
    for (const PosePair& q : pairs)
      extent_m = std::max(extent_m, (p.truth.translation_m - q.truth.translation_m).norm());
  }
  const double rms_mm = root_mean_square(shift_mm);
  return {{"aligned", free_scale ? "similarity" : "rigid"},
          {"extent_m", extent_m},
          {"rms_mm", rms_mm},
          {"p95_mm", measure::quantile(shift_mm, 0.95)},
          {"max_mm", *std::max_element(shift_mm.begin(), shift_mm.end())},
          {"rms_deg", root_mean_square(turn_deg)},
          {"rms_pct", extent_m > 0 ? 0.1 * rms_mm / extent_m : 0},
          {"drift_mm_per_1000", 1000 * slope_by_number(shift_mm)},
          {"metres_per_unit", on_truth->scale}};
}

}  // namespace mixrig::session
