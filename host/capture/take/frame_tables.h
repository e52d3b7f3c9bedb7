// SPDX-License-Identifier: Apache-2.0
// ticks.csv, pan_tilt.csv and lens.csv of a recorded take: tick, time and head angle of each frame,
// and encoder values of the lens over time. Private to this module.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "hal/device/pan_tilt.h"
#include "host/capture/capture/lens_track.h"
#include "host/capture/capture/truth.h"

namespace mixrig::take {

struct FrameTick {
  std::uint64_t tick = 0;
  HostTime mid_exposure{};  ///< on the recording host's clock
};

/// Parses ticks.csv: tick and mid-exposure of the plate of each frame, by frame number. The first
/// row of a frame is that of its plate. Pure. Errors: kFormat (name:line: ...).
Result<std::map<int, FrameTick>> parse_ticks(std::string_view text, const std::string& name);
inline constexpr const char* kTicksTable = "ticks.csv";
inline constexpr const char* kTicksHeader =
    "frame,stream,tick,counter,mid_exposure_ns,residual_us\n";
/// Writes a row of ticks.csv for a frame whose counter and residual are unknown.
std::string tick_row(int frame, std::string_view stream, const FrameTick& tick);
/// Parses pan_tilt.csv: angles of the head by frame number. Pure. Errors: kFormat (name:line: ...).
Result<std::map<int, device::PanTiltAngles>> parse_pan_tilt(std::string_view text,
                                                            const std::string& name);

/// Parses lens.csv: time_ns,zoom,focus; times grow. Pure. Errors: kFormat (name:line: ...).
Result<std::vector<capture::LensSample>> parse_lens_samples(std::string_view text,
                                                            const std::string& name);
inline constexpr const char* kLensHeader = "time_ns,zoom,focus\n";
std::string lens_row(const capture::LensSample& sample);

/// Parses truth/lens.csv: frame,fx_px,fy_px,cx_px,cy_px,pupil_shift_m of the view of each frame.
/// Pure. Errors: kFormat (name:line: ...).
Result<std::map<int, capture::TrueLens>> parse_true_lens(std::string_view text,
                                                         const std::string& name, Size view_px);
inline constexpr const char* kLensTable = "lens.csv";
inline constexpr const char* kTrueLensHeader = "frame,fx_px,fy_px,cx_px,cy_px,pupil_shift_m\n";
std::string true_lens_row(int frame, const capture::TrueLens& lens);

/// Parses truth/people.csv: frame,person,x_m,y_m,top_m,visible_m2 of each person in each frame.
/// Pure. Errors: kFormat (name:line: ...).
Result<std::map<int, std::vector<capture::TruePerson>>> parse_people(std::string_view text,
                                                                     const std::string& name);
inline constexpr const char* kPeopleTable = "people.csv";
inline constexpr const char* kPeopleHeader = "frame,person,x_m,y_m,top_m,visible_m2\n";
/// Writes the rows of one frame; empty without people.
std::string people_rows(int frame, const std::vector<capture::TruePerson>& people);

}  // namespace mixrig::take
