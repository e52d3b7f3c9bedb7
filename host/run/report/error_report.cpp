// SPDX-License-Identifier: Apache-2.0
#include "host/run/report/error_report.h"

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace mixrig::session {
namespace {

using NamedError = std::pair<const char*, std::optional<double>>;

std::array<NamedError, 18> named(const measure::Errors& e) {
  return {{{"depth_mae_mm", e.depth_mae_mm},
           {"depth_bad_pct", e.depth_bad_pct},
           {"hidden_pct", e.hidden_pct},
           {"hidden_bad_pct", e.hidden_bad_pct},
           {"hidden_wrong_pct", e.hidden_wrong_pct},
           {"band_bad_pct", e.band_bad_pct},
           {"mixed_bad_pct", e.mixed_bad_pct},
           {"mixed_hidden_wrong_pct", e.mixed_hidden_wrong_pct},
           {"key_iou", e.key_iou},
           {"matte_mse", e.matte_mse},
           {"matte_flicker", e.matte_flicker},
           {"matte_dtssd", e.matte_dtssd},
           {"order_wrong_pct", e.order_wrong_pct},
           {"light_rmse", e.light_rmse},
           {"light_shadow_rmse", e.light_shadow_rmse},
           {"color_psnr_db", e.color_psnr_db},
           {"object_rmse", e.object_rmse},
           {"object_psnr_db", e.object_psnr_db}}};
}

std::array<NamedError, 5> named(const measure::Errors::Contested& e) {
  return {{{"pixels_pct", e.pixels_pct},
           {"key_iou", e.key_iou},
           {"matte_mse", e.matte_mse},
           {"light_rmse", e.light_rmse},
           {"color_psnr_db", e.color_psnr_db}}};
}

std::array<NamedError, 5> named(const measure::Errors::Look& e) {
  return {{{"real_noise", e.real_noise},
           {"virtual_noise", e.virtual_noise},
           {"real_sharpness", e.real_sharpness},
           {"virtual_sharpness", e.virtual_sharpness},
           {"outline_sharpness", e.outline_sharpness}}};
}

std::array<NamedError, 9> named(const measure::Errors::Scraps& e) {
  return {{{"person_through_object", e.person_through_object},
           {"object_through_person", e.object_through_person},
           {"room_through", e.room_through},
           {"over_room", e.over_room},
           {"pixels", e.pixels},
           {"largest_px", e.largest_px},
           {"changed_pixels", e.changed_pixels},
           {"specks", e.specks},
           {"ghost_pixels", e.ghost_pixels}}};
}

std::array<NamedError, 4> named(const measure::Errors::Stairs& e) {
  return {{{"real_off_line_px", e.real_off_line_px},
           {"virtual_off_line_px", e.virtual_off_line_px},
           {"real_width_px", e.real_width_px},
           {"virtual_width_px", e.virtual_width_px}}};
}

template <std::size_t N>
nlohmann::json errors_json(const std::array<NamedError, N>& errors) {
  nlohmann::json out = nlohmann::json::object();
  for (const auto& [key, value] : errors) out[key] = or_null(value);
  return out;
}

/// A row for each measure, a column for each composite: the report's own first.
template <typename Measures>
std::string error_rows(const measure::Errors& errors, const std::vector<BaselineErrors>& baselines,
                       const char* prefix, const Measures& measures) {
  std::vector<decltype(named(measures(errors)))> columns{named(measures(errors))};
  for (const BaselineErrors& b : baselines) columns.push_back(named(measures(b.errors)));
  std::string out;
  for (std::size_t i = 0; i < columns.front().size(); ++i) {
    out += fmt::format("  {:<23}", std::string(prefix) + columns.front()[i].first);
    for (const auto& column : columns)
      out += column[i].second ? fmt::format(" {:>10.4g}", *column[i].second)
                              : fmt::format(" {:>10}", "-");
    out += "\n";
  }
  return out;
}

}  // namespace

double rounded(double value, int digits) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

nlohmann::json or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(rounded(*value)) : nlohmann::json();
}

std::string error_table(const measure::Errors& errors,
                        const std::vector<BaselineErrors>& baselines) {
  std::string out = "  error against truth";
  if (!baselines.empty()) out += fmt::format("    {:>12}", "mixrig");
  for (const BaselineErrors& b : baselines)
    out += fmt::format(" {:>10}", measure::name(b.baseline));
  out += "\n";
  out += error_rows(errors, baselines, "", [](const measure::Errors& e) { return e; });
  out += error_rows(errors, baselines, "contested ",
                    [](const measure::Errors& e) { return e.contested; });
  out +=
      error_rows(errors, baselines, "scraps ", [](const measure::Errors& e) { return e.scraps; });
  return out +
         error_rows(errors, baselines, "look ", [](const measure::Errors& e) { return e.look; });
}

nlohmann::json to_json(const measure::Errors& errors) {
  nlohmann::json out = errors_json(named(errors));
  out["contested"] = errors_json(named(errors.contested));
  out["scraps"] = errors_json(named(errors.scraps));
  out["stairs"] = errors_json(named(errors.stairs));
  out["look"] = errors_json(named(errors.look));
  return out;
}

}  // namespace mixrig::session
