// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/pose_lines.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>

#include "host/math/geometry/stamp_unit.h"

namespace mixrig::geometry {
namespace {

constexpr std::string_view kSpace = " \t\r";
constexpr std::size_t kRoles = 8;
/// What is read of a line, in the order of TUM's files.
constexpr std::array<std::string_view, kRoles> kRoleNames{"t",  "x",  "y",  "z",
                                                          "qx", "qy", "qz", "qw"};
constexpr const char* kOrder = "t x y z qx qy qz qw";

/// Where the columns of a file are, and their units.
struct PoseColumns {
  std::array<int, kRoles> at{0, 1, 2, 3, 4, 5, 6, 7};
  /// Number of columns: of each line the same. A comment may have words behind the names.
  std::size_t least = kRoles, most = kRoles;
  double time_unit_s = 0;  ///< 0: the file does not say
  double length_unit_m = 1;
  bool named = false;  ///< by a header
};

std::string_view trimmed_cell(std::string_view cell) {
  constexpr std::string_view kAround = " \t\r\"'";
  cell.remove_prefix(std::min(cell.find_first_not_of(kAround), cell.size()));
  return cell.substr(0, cell.find_last_not_of(kAround) + 1);
}

/// Cells between commas or semicolons where the line has any, else words. A comma at the end makes
/// no cell.
std::vector<std::string_view> split_cells(std::string_view line) {
  std::vector<std::string_view> cells;
  const bool parted = line.find_first_of(",;") != std::string_view::npos;
  const std::string_view separators = parted ? ",;" : kSpace;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(separators), line.size());
    const std::string_view cell = trimmed_cell(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
    if (!cell.empty() || (parted && trimmed_cell(line) != "")) cells.push_back(cell);
  }
  return cells;
}

/// A header's word in lower case, without the unit that it ends in.
struct ColumnName {
  std::string name, unit;
};

ColumnName column_name(std::string_view cell) {
  ColumnName out;
  for (const char c : cell)
    out.name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (const std::size_t bracket = out.name.find_first_of("[("); bracket != std::string::npos) {
    out.unit = out.name.substr(bracket + 1, out.name.find_first_of("])", bracket) - bracket - 1);
    out.name = trimmed_cell(out.name.substr(0, bracket));
  }
  for (const std::string_view unit :
       {"ns", "nsec", "us", "usec", "ms", "msec", "sec", "s", "mm", "cm", "m"}) {
    const std::string end = "_" + std::string(unit);
    if (!out.unit.empty() || !out.name.ends_with(end)) continue;
    out.unit = unit;
    out.name.resize(out.name.size() - end.size());
  }
  return out;
}

/// Index in kRoleNames of a column; nullopt for a column that is not read.
std::optional<std::size_t> role_of(const std::string& name) {
  if (name == "t" || name == "ts" || name.ends_with("time") || name.ends_with("stamp") ||
      name.ends_with("secs"))
    return 0;
  const std::size_t axis = name.empty() ? 4 : std::string_view("xyzw").find(name.back());
  if (axis > 3) return std::nullopt;
  std::string before = name.substr(0, name.size() - 1);
  const auto has = [&](std::string_view word) { return before.find(word) != std::string::npos; };
  while (!before.empty() && (before.back() == '_' || before.back() == '.')) before.pop_back();
  if (before.starts_with("q") || has("quat") || has("orient") || has("rot")) return 4 + axis;
  const bool place = before.empty() || before == "t" || before == "p" || before.starts_with("p_") ||
                     has("pos") || has("trans");
  return place && axis < 3 ? std::optional<std::size_t>(1 + axis) : std::nullopt;
}

double time_unit_of(const std::string& unit) {
  if (unit == "ns" || unit == "nsec") return 1e-9;
  if (unit == "us" || unit == "usec") return 1e-6;
  if (unit == "ms" || unit == "msec") return 1e-3;
  return unit == "s" || unit == "sec" ? 1.0 : 0.0;
}

/// A header that names its columns; its `missing` are empty where it names all that are read.
struct PoseHeader {
  PoseColumns columns;
  std::string missing, twice;
  int quaternion = 0;  ///< how many of its four columns are named
};

PoseHeader parse_pose_header(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(" \t#%"), line.size()));
  std::vector<std::string_view> cells = split_cells(line);
  if (line.find_first_of(",;") == std::string_view::npos)  // "[ns]" is of the word before
    std::erase_if(cells, [](std::string_view cell) { return cell[0] == '[' || cell[0] == '('; });
  PoseHeader header;
  header.columns.named = true;
  header.columns.most = cells.size();
  header.columns.at.fill(-1);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const ColumnName column = column_name(cells[i]);
    const auto role = role_of(column.name);
    if (!role) continue;
    int& at = header.columns.at[*role];
    // Of two times, such as that of a message and that of its arrival, the stamp.
    if (at >= 0 && *role == 0 && !column.name.ends_with("stamp")) continue;
    if (at >= 0 && *role != 0) {
      if (header.twice.empty()) header.twice = kRoleNames[*role];
      continue;
    }
    at = static_cast<int>(i);
    if (*role == 0) header.columns.time_unit_s = time_unit_of(column.unit);
    if (*role >= 1 && *role <= 3 && column.unit == "mm") header.columns.length_unit_m = 1e-3;
    if (*role >= 1 && *role <= 3 && column.unit == "cm") header.columns.length_unit_m = 1e-2;
  }
  for (std::size_t role = 0; role < kRoles; ++role) {
    const bool is_missing = header.columns.at[role] < 0;
    if (is_missing)
      header.missing += (header.missing.empty() ? "" : " ") + std::string(kRoleNames[role]);
    if (role >= 4 && !is_missing) ++header.quaternion;
  }
  return header;
}

class PoseLineReader {
 public:
  explicit PoseLineReader(const std::string& name) : name_(name) {}

  Result<void> take(std::string_view line, int number) {
    const std::size_t start = line.find_first_not_of(" \t\r,;\"");
    if (start == std::string_view::npos) return {};
    const bool comment = line[start] == '#';
    const bool words =
        line[start] == '%' || std::isalpha(static_cast<unsigned char>(line[start])) != 0;
    const std::string_view start_of = line.substr(start);
    const bool not_finite = start_of.starts_with("nan") || start_of.starts_with("inf");
    if (comment || (words && !not_finite && out_.poses.empty()))
      return header(line, number, comment);
    return row(line, number);
  }
  PoseLines finish() { return std::move(out_); }

 private:
  Error error(int number, const std::string& what) const {
    return {ErrorCode::kFormat, name_ + ":" + std::to_string(number) + ": " + what};
  }

  /// A comment is a header where it names a whole quaternion.
  Result<void> header(std::string_view line, int number, bool comment) {
    if (comment && !out_.poses.empty()) return {};
    const PoseHeader header = parse_pose_header(line);
    if (comment && header.quaternion < 4) return {};
    if (!header.missing.empty())
      return error(number, "the header names no column " + header.missing +
                               ": name the columns like " + kOrder +
                               ", or delete the header, to read lines in that order");
    const bool has_prose = comment && line.find_first_of(",;") == std::string_view::npos;
    if (!header.twice.empty() && !has_prose)
      return error(number, "the header names column " + header.twice +
                               " twice: leave one body in the file, with columns " + kOrder);
    columns_ = header.columns;
    columns_.least = comment ? 1 + static_cast<std::size_t>(*std::ranges::max_element(columns_.at))
                             : columns_.most;
    return {};
  }

  Result<void> row(std::string_view line, int number) {
    std::vector<std::string_view> cells = split_cells(line);
    if (!columns_.named && cells.size() != kRoles) cells = loose_cells(line);
    if (cells.size() < columns_.least || cells.size() > columns_.most)
      return error(number, "has " + std::to_string(cells.size()) + " columns, not " +
                               std::to_string(columns_.most) + ": " + expected());
    columns_.least = columns_.most = cells.size();
    std::array<double, kRoles> v{};
    for (std::size_t role = 0; role < kRoles; ++role) {
      const std::string_view cell = cells[static_cast<std::size_t>(columns_.at[role])];
      const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), v[role]);
      if (fault != std::errc() || end != cell.data() + cell.size())
        return error(number, "'" + std::string(cell.substr(0, 40)) + "' is no number for " +
                                 std::string(kRoleNames[role]) + ": " + expected());
    }
    out_.poses.push_back({number, v[0] * time_unit_s(v[0]),
                          columns_.length_unit_m * Eigen::Vector3d(v[1], v[2], v[3]),
                          Eigen::Quaterniond(v[7], v[4], v[5], v[6])});
    return {};
  }

  /// Words between blanks, commas and semicolons alike.
  static std::vector<std::string_view> loose_cells(std::string_view line) {
    std::vector<std::string_view> cells;
    while (true) {
      line.remove_prefix(std::min(line.find_first_not_of(" \t\r,;"), line.size()));
      if (line.empty()) return cells;
      const std::size_t end = std::min(line.find_first_of(" \t\r,;"), line.size());
      cells.push_back(line.substr(0, end));
      line.remove_prefix(end);
    }
  }

  std::string expected() const {
    if (columns_.named) return "its header names the columns: correct the line";
    return std::string("without a header the order is ") + kOrder +
           ": correct the line, or name the columns in a first line";
  }

  /// The first time tells the unit for all.
  double time_unit_s(double first) {
    if (columns_.time_unit_s == 0) {
      const StampUnit unit = unit_of_stamp(first);
      columns_.time_unit_s = unit.seconds;
      if (unit.seconds != 1) out_.guessed_unit = unit.name;
    }
    return columns_.time_unit_s;
  }

  const std::string& name_;
  PoseColumns columns_;
  PoseLines out_;
};

}  // namespace

Result<PoseLines> parse_pose_lines(std::string_view text, const std::string& name) {
  PoseLineReader reader(name);
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    MIXRIG_TRY(reader.take(text.substr(0, length), number));
    text.remove_prefix(std::min(length + 1, text.size()));
  }
  return reader.finish();
}

}  // namespace mixrig::geometry
