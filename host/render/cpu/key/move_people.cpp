// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/move_people.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace mixrig::render::cpu {
namespace {

/// Pixels that are read or written, half open.
Rect moved_area(const Image<glm::vec2>& shift_px, int cell_px, Size size) {
  Rect cells{shift_px.width(), shift_px.height(), 0, 0};
  int most = 0;
  for (int y = 0; y < shift_px.height(); ++y)
    for (int x = 0; x < shift_px.width(); ++x) {
      const glm::ivec2 s(shift_px.row(y)[x]);
      if (s == glm::ivec2(0)) continue;
      cells = {std::min(cells.x0, x), std::min(cells.y0, y), std::max(cells.x1, x + 1),
               std::max(cells.y1, y + 1)};
      most = std::max({most, std::abs(s.x), std::abs(s.y)});
    }
  if (cells.empty()) return {};
  return {std::max(0, cells.x0 * cell_px - most), std::max(0, cells.y0 * cell_px - most),
          std::min(size.width, cells.x1 * cell_px + most),
          std::min(size.height, cells.y1 * cell_px + most)};
}

}  // namespace

void move_people(Crew& crew, const Image<float>& limit_w, const Image<glm::vec2>& shift_px,
                 int cell_px, Image<float>& before, Image<float>& view_w) {
  const Size size = limit_w.size();
  const Rect area = moved_area(shift_px, cell_px, size);
  constexpr int kGrain = 8;
  const auto rows = [&](auto&& visit) {
    crew.rows(area.y1 - area.y0, kGrain, [&](int begin, int end) {
      for (int y = area.y0 + begin; y < area.y0 + end; ++y) visit(y);
    });
  };
  const auto in_front = [&](int x, int y) {
    return before.row(y)[x] > std::abs(limit_w.row(y)[x]);
  };
  if (area.empty()) return;
  rows([&](int y) {
    std::copy(view_w.row(y) + area.x0, view_w.row(y) + area.x1, before.row(y) + area.x0);
  });
  rows([&](int y) {
    const glm::vec2* shifts = shift_px.row(std::min(y / cell_px, shift_px.height() - 1));
    for (int x = area.x0; x < area.x1; ++x) {
      const glm::ivec2 s(shifts[std::min(x / cell_px, shift_px.width() - 1)]);
      if (s == glm::ivec2(0)) continue;
      const int from_x = std::clamp(x - s.x, 0, size.width - 1);
      const int from_y = std::clamp(y - s.y, 0, size.height - 1);
      if (in_front(from_x, from_y))
        view_w.row(y)[x] = before.row(from_y)[from_x];
      else if (in_front(x, y))
        view_w.row(y)[x] = 0;
    }
  });
}

}  // namespace mixrig::render::cpu
