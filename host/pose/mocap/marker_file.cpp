// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/marker_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "host/math/config/table.h"

namespace mixrig::mocap {
namespace {

using Cells = std::vector<std::string_view>;

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

Cells cells_of(std::string_view line) {
  Cells cells;
  for (std::size_t at = 0;;) {
    const auto comma = line.find(',', at);
    cells.push_back(trimmed(line.substr(at, comma == std::string_view::npos ? comma : comma - at)));
    if (comma == std::string_view::npos) return cells;
    at = comma + 1;
  }
}

/// Indices of the columns; -1 for a missing one.
struct Columns {
  int frame, t, x, y, z, id, marker, occluded, residual, valid, error;
  int q[4];  // x y z w
  bool of_bodies() const { return q[0] >= 0; }
};

int column(const Cells& header, std::initializer_list<std::string_view> names) {
  for (std::string_view name : names) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found != header.end()) return static_cast<int>(found - header.begin());
  }
  return -1;
}

Result<Columns> columns_of(const Cells& header, const std::string& name) {
  const auto at = [&](auto... names) { return column(header, {names...}); };
  const Columns c{at("frame"),     at("t_s", "t"),     at("x_m", "x"),
                  at("y_m", "y"),  at("z_m", "z"),     at("id", "model_id"),
                  at("marker_id"), at("occluded"),     at("residual_m"),
                  at("valid"),     at("mean_error_m"), {at("qx"), at("qy"), at("qz"), at("qw")}};
  const auto lacks = [&](const char* what) {
    return Error{ErrorCode::kFormat, name + ":1: there is no column " + what +
                                         ": the first line must name the columns"};
  };
  if (c.frame < 0) return lacks("frame");
  if (c.t < 0) return lacks("t_s");
  if (c.x < 0 || c.y < 0 || c.z < 0) return lacks("x_m, y_m or z_m");
  if (c.of_bodies() && (c.q[1] < 0 || c.q[2] < 0 || c.q[3] < 0)) return lacks("qy, qz or qw");
  if (c.of_bodies() && c.id < 0) return lacks("id");
  return c;
}

/// One line's numbers. After an invalid cell, `broken` names its column and all values read 0.
class Line {
 public:
  Line(const Cells& cells, const Cells& header) : cells_(cells), header_(header) {}
  double number(int at, double fallback = 0) {
    if (at < 0 || !broken.empty()) return fallback;
    const auto i = static_cast<std::size_t>(at);
    double value = 0;
    if (i < cells_.size()) {
      const std::string_view cell = cells_[i];
      const auto [end, code] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (code == std::errc() && end == cell.data() + cell.size() && std::isfinite(value))
        return value;
    }
    broken = header_[i];
    return fallback;
  }
  /// Returns an integer cell that fits an int.
  int integer(int at, int fallback = 0) {
    const double value = number(at, fallback);
    if (std::abs(value) < 2e9 && value == std::floor(value)) return static_cast<int>(value);
    if (broken.empty()) broken = header_[static_cast<std::size_t>(at)];
    return fallback;
  }
  std::string broken;

 private:
  const Cells& cells_;
  const Cells& header_;
};

void add_line(Line& line, const Columns& c, std::vector<stream::NatNetFrame>& frames) {
  const int number = line.integer(c.frame);
  const double time_s = line.number(c.t);
  const double x = line.number(c.x), y = line.number(c.y), z = line.number(c.z);
  if (frames.empty() || frames.back().number != number) {
    frames.emplace_back();
    frames.back().number = number;
    frames.back().time_s = time_s;
  }
  if (!c.of_bodies()) {
    frames.back().markers.push_back({line.integer(c.id),
                                     line.integer(c.marker),
                                     {x, y, z},
                                     line.integer(c.occluded) != 0,
                                     line.number(c.residual)});
    return;
  }
  const double qx = line.number(c.q[0]), qy = line.number(c.q[1]), qz = line.number(c.q[2]);
  const Eigen::Quaterniond q(line.number(c.q[3]), qx, qy, qz);
  const bool is_rotation = std::abs(q.norm() - 1) < 1e-2;
  frames.back().bodies.push_back(
      {line.integer(c.id),
       {is_rotation ? q.normalized() : Eigen::Quaterniond::Identity(), {x, y, z}},
       line.number(c.error),
       is_rotation && line.integer(c.valid, 1) != 0});
}

}  // namespace

Result<std::vector<stream::NatNetFrame>> parse_mocap_csv(std::string_view text,
                                                         const std::string& name) {
  std::vector<stream::NatNetFrame> frames;
  std::optional<Columns> columns;
  Cells header;
  for (int number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    const std::string_view row = trimmed(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    if (row.empty() || row.front() == '#') continue;
    const Cells cells = cells_of(row);
    if (!columns) {
      header = cells;
      MIXRIG_ASSIGN(columns, columns_of(header, name));
      continue;
    }
    Line line(cells, header);
    add_line(line, *columns, frames);
    if (!line.broken.empty())
      return Error{ErrorCode::kFormat, name + ":" + std::to_string(number) + ": column " +
                                           line.broken + " holds no number: correct it"};
  }
  if (!columns)
    return Error{ErrorCode::kFormat, name + ":1: empty: the first line must name the columns"};
  return frames;
}

Result<std::vector<stream::NatNetFrame>> read_mocap_csv(const std::filesystem::path& path) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 30;
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMostBytes));
  return parse_mocap_csv(text, path.string());
}

}  // namespace mixrig::mocap
