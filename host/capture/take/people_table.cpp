// SPDX-License-Identifier: Apache-2.0
// truth/people.csv.
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "host/capture/take/csv_rows.h"
#include "host/capture/take/frame_tables.h"

namespace mixrig::take {
namespace {

constexpr double kFarthest_m = 1e4;

bool is_a_place(const capture::TruePerson& p) {
  return p.number >= 0 && std::abs(p.x_m) < kFarthest_m && std::abs(p.y_m) < kFarthest_m &&
         p.top_m >= 0 && p.top_m < kFarthest_m && p.visible_m2 >= 0 && p.visible_m2 < kFarthest_m;
}

}  // namespace

Result<std::map<int, std::vector<capture::TruePerson>>> parse_people(std::string_view text,
                                                                     const std::string& name) {
  std::map<int, std::vector<capture::TruePerson>> people;
  MIXRIG_TRY(for_each_row(text, name, 6, [&](const std::vector<std::string_view>& cells) {
    int frame = 0;
    capture::TruePerson p;
    if (!parse_cell(cells[0], frame) || !parse_cell(cells[1], p.number) ||
        !parse_cell(cells[2], p.x_m) || !parse_cell(cells[3], p.y_m) ||
        !parse_cell(cells[4], p.top_m) || !parse_cell(cells[5], p.visible_m2) || !is_a_place(p))
      return false;
    people[frame].push_back(p);
    return true;
  }));
  return people;
}

std::string people_rows(int frame, const std::vector<capture::TruePerson>& people) {
  std::string rows;
  for (const capture::TruePerson& p : people)
    fmt::format_to(std::back_inserter(rows), "{},{},{:.4f},{:.4f},{:.4f},{:.4f}\n", frame, p.number,
                   p.x_m, p.y_m, p.top_m, p.visible_m2);
  return rows;
}

}  // namespace mixrig::take
