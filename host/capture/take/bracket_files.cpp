// SPDX-License-Identifier: Apache-2.0
#include "host/capture/take/bracket_files.h"

#include <iterator>

#include <fmt/format.h>

#include "host/capture/take/csv_rows.h"
#include "host/math/config/table.h"
#include "host/math/image_io/image_io.h"

namespace mixrig::take {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBracketTable_bytes = std::size_t{4} << 20;
constexpr double kLeastExposure_s = 1e-7, kMostExposure_s = 1e3;

bool is_exposure(double s) { return s >= kLeastExposure_s && s <= kMostExposure_s; }

fs::path bracket_path(const fs::path& folder, int number) {
  return folder / "bracket" / fmt::format("{:06d}.png", number);
}

}  // namespace

Result<std::vector<BracketRow>> parse_bracket_table(std::string_view text,
                                                    const std::string& name) {
  std::vector<BracketRow> rows;
  MIXRIG_TRY(for_each_row(text, name, 4, [&](const std::vector<std::string_view>& cells) {
    int picture = 0;
    BracketRow row;
    if (!parse_cell(cells[0], picture) || !parse_cell(cells[1], row.frame) ||
        !parse_cell(cells[2], row.exposure_s) || !parse_cell(cells[3], row.frames_s))
      return false;
    if (picture != static_cast<int>(rows.size()) + 1 || row.frame < 1 ||
        (!rows.empty() && row.frame < rows.back().frame) || !is_exposure(row.exposure_s) ||
        !is_exposure(row.frames_s))
      return false;
    rows.push_back(row);
    return true;
  }));
  return rows;
}

std::string bracket_text(const std::vector<BracketRow>& rows) {
  std::string text = kBracketHeader;
  int picture = 0;
  for (const BracketRow& row : rows)
    fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", ++picture, row.frame, row.exposure_s,
                   row.frames_s);
  return text;
}

Result<std::vector<BracketRow>> read_bracket_table(const fs::path& folder) {
  const fs::path path = folder / kBracketTable;
  std::error_code error;
  if (!fs::exists(path, error)) return std::vector<BracketRow>();
  MIXRIG_ASSIGN(const std::string text, config::read_text(path, kMostBracketTable_bytes));
  return parse_bracket_table(text, path.string());
}

Result<void> read_bracket_plate(const fs::path& folder, int number, Image<Rgb8>& plate) {
  return image_io::read_rgb8(bracket_path(folder, number), plate);
}

Result<void> write_bracket_plate(const fs::path& folder, int number, ImageView<const Rgb8> plate) {
  const fs::path path = bracket_path(folder, number);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  if (error)
    return system_error(ErrorCode::kIo, "cannot make folder '" + path.parent_path().string() + "'",
                        error.value());
  return image_io::write_png(path, plate);
}

}  // namespace mixrig::take
