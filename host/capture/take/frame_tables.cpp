// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/frame_tables.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "host/capture/take/csv_rows.h"
#include "host/capture/take/streams/fisheye_stream.h"

namespace mixrig::take {
Result<std::map<int, FrameTick>> parse_ticks(std::string_view text, const std::string& name) {
  std::map<int, FrameTick> ticks;
  MIXRIG_TRY(for_each_row(text, name, 6, [&](const std::vector<std::string_view>& cells) {
    int frame = 0;
    FrameTick tick;
    std::int64_t ns = 0;
    if (!parse_cell(cells[0], frame) || !parse_cell(cells[2], tick.tick) ||
        !parse_cell(cells[4], ns))
      return false;
    tick.mid_exposure = HostTime(std::chrono::nanoseconds(ns));
    ticks.emplace(frame, tick);
    return true;
  }));
  return ticks;
}

std::string tick_row(int frame, std::string_view stream, const FrameTick& tick) {
  return fmt::format("{},{},{},0,{},0.0\n", frame, stream, tick.tick,
                     tick.mid_exposure.time_since_epoch().count());
}

Result<std::map<int, device::PanTiltAngles>> parse_pan_tilt(std::string_view text,
                                                            const std::string& name) {
  std::map<int, device::PanTiltAngles> angles;
  MIXRIG_TRY(for_each_row(text, name, 3, [&](const std::vector<std::string_view>& cells) {
    int frame = 0;
    device::PanTiltAngles at;
    if (!parse_cell(cells[0], frame) || !parse_cell(cells[1], at.pan_rad) ||
        !parse_cell(cells[2], at.tilt_rad) || !std::isfinite(at.pan_rad) ||
        !std::isfinite(at.tilt_rad))
      return false;
    angles.emplace(frame, at);
    return true;
  }));
  return angles;
}

Result<std::vector<FisheyeStamp>> parse_fisheye_table(std::string_view text,
                                                      const std::string& name) {
  std::vector<FisheyeStamp> stamps;
  MIXRIG_TRY(for_each_row(text, name, 4, [&](const std::vector<std::string_view>& cells) {
    FisheyeStamp stamp;
    std::size_t picture = 0;
    std::int64_t ns = 0;
    if (!parse_cell(cells[0], picture) || !parse_cell(cells[1], stamp.frame) ||
        !parse_cell(cells[2], stamp.counter) || !parse_cell(cells[3], ns))
      return false;
    stamp.mid_exposure = HostTime(std::chrono::nanoseconds(ns));
    if (picture != stamps.size() + 1 || stamp.frame < 1) return false;
    if (!stamps.empty() &&
        (stamp.frame <= stamps.back().frame || stamp.mid_exposure <= stamps.back().mid_exposure))
      return false;
    stamps.push_back(stamp);
    return true;
  }));
  return stamps;
}

std::string fisheye_row(int picture, const FisheyeStamp& stamp) {
  return fmt::format("{},{},{},{}\n", picture, stamp.frame, stamp.counter,
                     stamp.mid_exposure.time_since_epoch().count());
}

}  // namespace mixrig::take
