// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/sweep_plan.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>

namespace mixrig::model {
namespace {

constexpr double kFullCircle_rad = 2 * std::numbers::pi;
constexpr double kTrialStep_rad = 1.5 * std::numbers::pi / 180;
constexpr int kMoreRows = 12;  ///< than the camera's height needs at least
constexpr int kMostColumns = 90;
constexpr double kLevel_rad = 1e-6;

Result<void> check_task(const SweepTask& t) {
  const auto within = [](double value, double most) { return value > 0 && value <= most + 1e-9; };
  const auto wrong = [](const char* what) {
    return Error{ErrorCode::kUsage, fmt::format("sweep: {}", what)};
  };
  if (!within(t.field_pan_rad, kFullCircle_rad) || !within(t.field_tilt_rad, std::numbers::pi))
    return wrong("the field must be above 0 and at most 360 x 180 degrees");
  if (!within(t.camera_pan_rad, 3) || !within(t.camera_tilt_rad, 3))
    return wrong("the field of view must be above 0 and at most 170 degrees");
  if (!(t.overlap >= 0 && t.overlap <= 0.9)) return wrong("the overlap must be 0 to 0.9");
  if (t.most_views < 0) return wrong("the number of views must not be negative");
  if (!(t.most_pan_rad >= 0 && t.most_tilt_rad >= 0 && t.most_down_rad.value_or(0) >= 0))
    return wrong("limits must not be negative");
  return {};
}

/// Angles at most a trial step apart, both ends among them.
std::vector<double> trials(double from_rad, double to_rad) {
  const int steps = std::max(1, static_cast<int>(std::ceil((to_rad - from_rad) / kTrialStep_rad)));
  std::vector<double> angles;
  for (int i = 0; i <= steps; ++i) angles.push_back(from_rad + (to_rad - from_rad) * i / steps);
  return angles;
}

/// `count` views of one tilt, their pans spread evenly over the field.
std::vector<HeadView> row_of(const SweepTask& t, double tilt_rad, int count, double part) {
  std::vector<HeadView> row;
  const bool closed = t.field_pan_rad > kFullCircle_rad - 1e-6;
  const double first =
      closed ? -std::numbers::pi : -0.5 * (t.field_pan_rad - part * t.camera_pan_rad);
  for (int i = 0; i < count; ++i) {
    double pan = 0;
    if (count > 1)
      pan = closed ? first + kFullCircle_rad * i / count : first - 2 * first * i / (count - 1);
    row.push_back({std::clamp(pan, -t.most_pan_rad, t.most_pan_rad), tilt_rad});
  }
  return row;
}

bool row_covers(const SweepTask& t, const std::vector<HeadView>& row, double low, double high,
                double part) {
  const double half = 0.5 * t.field_pan_rad;
  for (const double elevation : trials(low, high))
    for (const double azimuth : trials(-half, half))
      if (std::none_of(row.begin(), row.end(),
                       [&](const HeadView& v) { return sees(t, v, azimuth, elevation, part); }))
        return false;
  return true;
}

/// The shortest row that covers a band; nothing where no row does.
std::vector<HeadView> shortest_row(const SweepTask& t, double tilt, double low, double high,
                                   double part) {
  for (int count = 1; count <= kMostColumns; ++count) {
    std::vector<HeadView> row = row_of(t, tilt, count, part);
    if (row_covers(t, row, low, high, part)) return row;
  }
  return {};
}

/// All rows, or nothing where a row cannot cover its band.
std::vector<HeadView> plan_rows(const SweepTask& t, int rows, double reach, double part) {
  std::vector<HeadView> views;
  for (int i = 0; i < rows; ++i) {
    const double band = 2 * reach / rows;
    const double low = -reach + band * i, high = low + band;
    const double tilt = std::clamp(0.5 * (low + high), -t.most_tilt_rad, t.most_tilt_rad);
    std::vector<HeadView> row = shortest_row(t, tilt, low, high, part);
    if (row.empty()) return {};
    if (i % 2 == 1) std::reverse(row.begin(), row.end());
    views.insert(views.end(), row.begin(), row.end());
  }
  return views;
}

/// The plan with the fewest views of the first few numbers of rows that cover.
std::vector<HeadView> best_rows(const SweepTask& t, double reach, double part) {
  constexpr int kTries = 4;
  const int least = std::max(1, static_cast<int>(2 * reach / t.camera_tilt_rad));
  std::vector<HeadView> best;
  int tried = 0;
  for (int rows = least; rows <= least + kMoreRows && tried < kTries; ++rows) {
    std::vector<HeadView> views = plan_rows(t, rows, reach, part);
    if (views.empty()) continue;
    ++tried;
    if (best.empty() || views.size() < best.size()) best = std::move(views);
  }
  return best;
}

double covered_share_of(const SweepTask& t, const std::vector<HeadView>& views) {
  double all = 0, covered = 0;
  for (const double elevation : trials(-0.5 * t.field_tilt_rad, 0.5 * t.field_tilt_rad))
    for (const double azimuth : trials(-0.5 * t.field_pan_rad, 0.5 * t.field_pan_rad)) {
      all += std::cos(elevation);
      if (std::any_of(views.begin(), views.end(),
                      [&](const HeadView& v) { return sees(t, v, azimuth, elevation); }))
        covered += std::cos(elevation);
    }
  return covered / all;
}

/// Views for a unit that turns as far down as up; empty where nothing covers the field.
std::vector<HeadView> plan_both_ways(const SweepTask& task) {
  const double part = 1 - task.overlap;
  SweepTask within = task;  // what the unit can reach
  within.field_pan_rad =
      std::min(task.field_pan_rad, 2 * task.most_pan_rad + part * task.camera_pan_rad);
  std::vector<HeadView> views;
  // The corners of a view at the limit see less far up than its middle: less is asked for then.
  for (double reach = std::min(0.5 * task.field_tilt_rad,
                               task.most_tilt_rad + 0.5 * part * task.camera_tilt_rad);
       views.empty() && reach > kTrialStep_rad; reach -= kTrialStep_rad)
    views = best_rows(within, reach, part);
  return views;
}

/// Half the distance to the next row of the row that looks level; 0 where a plan has no such row.
double half_level_band(const std::vector<HeadView>& views) {
  bool level = false;
  double next = std::numbers::pi;
  for (const HeadView& view : views) {
    level = level || std::abs(view.tilt_rad) < kLevel_rad;
    if (view.tilt_rad > kLevel_rad) next = std::min(next, view.tilt_rad);
  }
  return level ? 0.5 * next : 0;
}

/// The rows of `below` that look down, those of `above` that look up, and of the level rows the one
/// whose band is higher; each row against the one before.
std::vector<HeadView> joined(const std::vector<HeadView>& below,
                             const std::vector<HeadView>& above) {
  std::vector<HeadView> views;
  const auto& middle = half_level_band(below) > half_level_band(above) ? below : above;
  const auto take = [&](const std::vector<HeadView>& from, auto wanted) {
    std::copy_if(from.begin(), from.end(), std::back_inserter(views), wanted);
  };
  take(below, [](const HeadView& v) { return v.tilt_rad < -kLevel_rad; });
  take(middle, [](const HeadView& v) { return std::abs(v.tilt_rad) <= kLevel_rad; });
  take(above, [](const HeadView& v) { return v.tilt_rad > kLevel_rad; });
  for (std::size_t begin = 0, end = 0, row = 0; begin < views.size(); begin = end, ++row) {
    while (end < views.size() && views[end].tilt_rad == views[begin].tilt_rad) ++end;
    const bool rises = end - begin > 1 && views[begin].pan_rad < views[begin + 1].pan_rad;
    if (end - begin > 1 && rises != (row % 2 == 0))
      std::reverse(views.begin() + static_cast<std::ptrdiff_t>(begin),
                   views.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return views;
}

/// Views for any unit; empty where nothing covers the field.
std::vector<HeadView> views_of(const SweepTask& task) {
  std::vector<HeadView> views = plan_both_ways(task);
  if (const auto& down = task.most_down_rad; down && *down != task.most_tilt_rad) {
    SweepTask below = task;
    below.most_tilt_rad = *down;
    views = joined(plan_both_ways(below), views);
  }
  return views;
}

bool is_within(const SweepTask& task, const std::vector<HeadView>& views) {
  return task.most_views == 0 || views.size() <= static_cast<std::size_t>(task.most_views);
}

/// Plans the highest field that SweepTask::most_views cover, to a degree; no views where none is.
void lower_field(const SweepTask& task, SweepPlan& plan) {
  constexpr double kStep_rad = std::numbers::pi / 180;
  plan = {};
  double low = 0, high = task.field_tilt_rad;
  while (high - low > kStep_rad) {
    SweepTask lower = task;
    lower.field_tilt_rad = 0.5 * (low + high);
    std::vector<HeadView> views = views_of(lower);
    const bool fits = !views.empty() && is_within(task, views);
    (fits ? low : high) = lower.field_tilt_rad;
    if (fits) plan = {std::move(views), lower.field_tilt_rad, 0};
  }
}

}  // namespace

bool sees(const SweepTask& task, const HeadView& view, double azimuth_rad, double elevation_rad,
          double part) {
  const double left_of = azimuth_rad - view.pan_rad;
  const double ahead = std::cos(elevation_rad) * std::cos(left_of);
  const double side = std::cos(elevation_rad) * std::sin(left_of), up = std::sin(elevation_rad);
  const double c = std::cos(view.tilt_rad), s = std::sin(view.tilt_rad);
  const double forward = c * ahead + s * up, above = c * up - s * ahead;
  return forward > 0 &&
         std::abs(side) <= forward * std::tan(0.5 * part * task.camera_pan_rad) + 1e-12 &&
         std::abs(above) <= forward * std::tan(0.5 * part * task.camera_tilt_rad) + 1e-12;
}

Result<SweepPlan> plan_sweep(const SweepTask& task) {
  MIXRIG_TRY(check_task(task));
  SweepPlan plan{views_of(task), task.field_tilt_rad, 0};
  if (plan.views.empty())
    return Error{ErrorCode::kUsage,
                 "sweep: no plan covers the field: lower the overlap or the field"};
  if (!is_within(task, plan.views)) lower_field(task, plan);
  if (plan.views.empty())
    return Error{ErrorCode::kUsage,
                 fmt::format("sweep: {} views do not cover one row of the field: allow more, or "
                             "lower the overlap or the field",
                             task.most_views)};
  plan.covered_share = covered_share_of(task, plan.views);
  return plan;
}

}  // namespace mixrig::model
