// SPDX-License-Identifier: Apache-2.0
// lens.csv and truth/lens.csv.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/take/csv_rows.h"
#include "host/take/frame_tables.h"

namespace mixrig::take {
namespace {

/// Whether two times lie further apart than `gap`; their difference may overflow, the halves' not.
bool apart(HostTime before, HostTime after, Duration gap) {
  return after.time_since_epoch() / 2 - before.time_since_epoch() / 2 > gap / 2;
}

}  // namespace

Result<std::vector<LensSample>> parse_lens_samples(std::string_view text, const std::string& name) {
  std::vector<LensSample> samples;
  MIXRIG_TRY(for_each_row(text, name, 3, [&](const std::vector<std::string_view>& cells) {
    std::int64_t ns = 0;
    LensSample sample;
    if (!parse_cell(cells[0], ns) || !parse_cell(cells[1], sample.at.zoom) ||
        !parse_cell(cells[2], sample.at.focus) || !std::isfinite(sample.at.zoom) ||
        !std::isfinite(sample.at.focus))
      return false;
    sample.time = HostTime(std::chrono::nanoseconds(ns));
    if (!samples.empty() && sample.time <= samples.back().time) return false;
    samples.push_back(sample);
    return true;
  }));
  return samples;
}

std::optional<geometry::LensEncoders> lens_at(std::span<const LensSample> samples, HostTime time) {
  const auto after = std::lower_bound(samples.begin(), samples.end(), time,
                                      [](const LensSample& s, HostTime t) { return s.time < t; });
  const auto near = [&](const LensSample& s) {
    const bool there = !apart(std::min(s.time, time), std::max(s.time, time), kMostLensGap / 2);
    return there ? std::optional(s.at) : std::nullopt;
  };
  if (samples.empty()) return std::nullopt;
  if (after == samples.end()) return near(samples.back());
  if (after->time == time || after == samples.begin()) return near(*after);
  const LensSample& a = *std::prev(after);
  if (apart(a.time, after->time, kMostLensGap)) return std::nullopt;
  const double t = seconds(time - a.time) / seconds(after->time - a.time);
  return geometry::LensEncoders{a.at.zoom + t * (after->at.zoom - a.at.zoom),
                                a.at.focus + t * (after->at.focus - a.at.focus)};
}

Result<std::map<int, capture::TrueLens>> parse_true_lens(std::string_view text,
                                                         const std::string& name, Size view_px) {
  std::map<int, capture::TrueLens> lenses;
  MIXRIG_TRY(for_each_row(text, name, 6, [&](const std::vector<std::string_view>& cells) {
    int frame = 0;
    capture::TrueLens lens;
    lens.view.size_px = view_px;
    if (!parse_cell(cells[0], frame) || !parse_cell(cells[1], lens.view.fx_px) ||
        !parse_cell(cells[2], lens.view.fy_px) || !parse_cell(cells[3], lens.view.cx_px) ||
        !parse_cell(cells[4], lens.view.cy_px) || !parse_cell(cells[5], lens.pupil_shift_m))
      return false;
    if (!geometry::validate(geometry::CameraModel{lens.view, {}}) ||
        !(std::abs(lens.pupil_shift_m) <= 1))
      return false;
    return lenses.emplace(frame, lens).second;
  }));
  return lenses;
}

std::string true_lens_row(int frame, const capture::TrueLens& lens) {
  const geometry::Pinhole& v = lens.view;
  return fmt::format("{},{},{},{},{},{}\n", frame, v.fx_px, v.fy_px, v.cx_px, v.cy_px,
                     lens.pupil_shift_m);
}

}  // namespace mixrig::take
