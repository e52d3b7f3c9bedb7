// SPDX-License-Identifier: Apache-2.0
#include "host/take/frame_tables.h"

#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "host/take/fisheye_stream.h"

namespace mixrig::take {
namespace {

constexpr std::size_t kMostCells = 8;

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (cells.size() < kMostCells) {
    const std::size_t comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) break;
    line.remove_prefix(comma + 1);
  }
  return cells;
}

template <typename Number>
bool parse(std::string_view cell, Number& value) {
  const char* end = cell.data() + cell.size();
  const auto [stop, fault] = std::from_chars(cell.data(), end, value);
  return fault == std::errc() && stop == end && !cell.empty();
}

/// Calls `row(cells)` for each line after the header; a line where it returns false is an error.
template <typename Row>
Result<void> for_each_row(std::string_view text, const std::string& name, std::size_t columns,
                          Row&& row) {
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    std::string_view words = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!words.empty() && words.back() == '\r') words.remove_suffix(1);
    if (line == 1 || words.empty()) continue;
    const std::vector<std::string_view> cells = cells_of(words);
    if (cells.size() != columns || !row(cells))
      return Error{ErrorCode::kFormat,
                   fmt::format("{}:{}: not a row of {} columns: delete the file to read the take "
                               "without it",
                               name, line, columns)};
  }
  return {};
}

}  // namespace

Result<std::map<int, FrameTick>> parse_ticks(std::string_view text, const std::string& name) {
  std::map<int, FrameTick> ticks;
  MIXRIG_TRY(for_each_row(text, name, 6, [&](const std::vector<std::string_view>& cells) {
    int frame = 0;
    FrameTick tick;
    std::int64_t ns = 0;
    if (!parse(cells[0], frame) || !parse(cells[2], tick.tick) || !parse(cells[4], ns))
      return false;
    tick.mid_exposure = HostTime(std::chrono::nanoseconds(ns));
    ticks.emplace(frame, tick);
    return true;
  }));
  return ticks;
}

Result<std::map<int, device::PanTiltAngles>> parse_pan_tilt(std::string_view text,
                                                            const std::string& name) {
  std::map<int, device::PanTiltAngles> angles;
  MIXRIG_TRY(for_each_row(text, name, 3, [&](const std::vector<std::string_view>& cells) {
    int frame = 0;
    device::PanTiltAngles at;
    if (!parse(cells[0], frame) || !parse(cells[1], at.pan_rad) || !parse(cells[2], at.tilt_rad) ||
        !std::isfinite(at.pan_rad) || !std::isfinite(at.tilt_rad))
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
    if (!parse(cells[0], picture) || !parse(cells[1], stamp.frame) ||
        !parse(cells[2], stamp.counter) || !parse(cells[3], ns))
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
