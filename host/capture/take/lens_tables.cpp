// SPDX-License-Identifier: Apache-2.0
// lens.csv and truth/lens.csv.
#include <cmath>

#include <fmt/format.h>

#include "host/capture/take/csv_rows.h"
#include "host/capture/take/frame_tables.h"

namespace mixrig::take {
Result<std::vector<capture::LensSample>> parse_lens_samples(std::string_view text,
                                                            const std::string& name) {
  std::vector<capture::LensSample> samples;
  MIXRIG_TRY(for_each_row(text, name, 3, [&](const std::vector<std::string_view>& cells) {
    std::int64_t ns = 0;
    capture::LensSample sample;
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

std::string lens_row(const capture::LensSample& sample) {
  return fmt::format("{},{},{}\n", sample.time.time_since_epoch().count(), sample.at.zoom,
                     sample.at.focus);
}

std::string true_lens_row(int frame, const capture::TrueLens& lens) {
  const geometry::Pinhole& v = lens.view;
  return fmt::format("{},{},{},{},{},{}\n", frame, v.fx_px, v.fy_px, v.cx_px, v.cy_px,
                     lens.pupil_shift_m);
}

}  // namespace mixrig::take
