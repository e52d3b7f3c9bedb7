// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/people_cells.h"

#include <algorithm>

#include "host/render/cpu/background_corners.h"

namespace mixrig::render::cpu {
namespace {

/// Of all light: where less is lost of the lamps at the corners, what people leave of them on the
/// whole counts too.
constexpr float kFaintShadow = 0.02F;
/// Of the share of a lamp over a cell: people's penumbrae are wide, and bend little within it.
constexpr float kMostPeopleChange = 0.25F;

/// What LostLight has, at the corners.
struct LostCorners {
  CornerValues ambient, lamps, past_people, by_people;
};

LostCorners lost_corners(const LightInput& input, const Doubt& doubt, const PeopleCells& people,
                         const BackgroundCorners& corners) {
  LostCorners out;
  std::array<FloatLanes, kMostLamps> share;
  const std::span seen = std::span(share).first(people.seen().size());
  for (std::size_t i = 0; i < corners.at.size(); ++i) {
    people.seen_of_register(i, seen);
    const LostLight lost =
        lost_light(input.frame, input.maps, doubt.lamps, doubt.near, corners.at[i], seen);
    const std::size_t to = i * kLanes;
    store(&out.ambient[to], lost.ambient), store(&out.by_people[to], lost.by_people);
    store(&out.lamps[to], lost.lamps + kFaintShadow);
    store(&out.past_people[to], lost.past_people + kFaintShadow * lost.seen);
  }
  return out;
}

/// A flat cell: `background` without people.
void light_flat_past_people(const LostCorners& lost, const CellOf& c, const Rect& rect,
                            const Image<std::uint16_t>& background, Image<std::uint16_t>& out) {
  const auto each = [&](const CornerValues& v, std::array<float, kCellPx * kCellPx>& to) {
    between(v, c,
            [&](int x, int y, float f) { to[static_cast<std::size_t>(y * kCellPx + x)] = f; });
  };
  std::array<float, kCellPx * kCellPx> ambient, lamps, past_people, by_people;
  each(lost.ambient, ambient), each(lost.lamps, lamps);
  each(lost.past_people, past_people), each(lost.by_people, by_people);
  for (std::size_t i = 0; i < ambient.size(); ++i) {
    const int x = rect.x0 + static_cast<int>(i) % kCellPx,
              y = rect.y0 + static_cast<int>(i) / kCellPx;
    const float without = static_cast<float>(background.row(y)[x]) * (1 / kLinearOne);
    const float of_lamps = (1 - without - ambient[i]) * past_people[i] / lamps[i];
    const float left = 1 - by_people[i];
    out.row(y)[x] = light_to_fixed((left - ambient[i] - of_lamps) / std::max(left, kFaintShadow));
  }
}

}  // namespace

PeopleCells::PeopleCells(const PeopleMaps& people, std::span<const SurfaceLanes> at)
    : count_(std::min(people.maps.size(), seen_.size())), maybe_(people.maybe) {
  std::array<FloatLanes, kMostLamps> share;
  for (std::size_t i = 0; i < at.size(); ++i) {
    hide_any_ |= seen_past_people(people, at[i], std::span(share).first(count_));
    for (std::size_t k = 0; k < count_; ++k) store(&seen_[k][i * kLanes], share[k]);
  }
}

bool PeopleCells::hide(const CellOf& c) const {
  for (std::size_t k = 0; k < count_; ++k)
    if (holds(maybe_, k) &&
        std::min({seen_[k][c.a], seen_[k][c.b], seen_[k][c.c], seen_[k][c.d]}) < 1)
      return true;
  return false;
}

bool PeopleCells::change(const CellOf& c) const {
  for (std::size_t k = 0; k < count_; ++k)
    if (holds(maybe_, k) && change_over(seen_[k], c) > kMostPeopleChange) return true;
  return false;
}

void PeopleCells::seen_of_register(std::size_t i, std::span<FloatLanes> out) const {
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = load<FloatLanes>(&seen_[k][i * kLanes]);
}

void light_cells_past_people(const LightInput& input, const Doubt& doubt, const PeopleMaps& people,
                             ImageView<const float> depth_m, const Rect& tile, LightLayer& light,
                             const std::function<void(const Rect&)>& each_pixel) {
  const BackgroundCorners corners = background_corners(input, depth_m, tile);
  const PeopleCells cells(people, corners.at);
  if (!cells.hide_any()) return;
  const LostCorners lost = lost_corners(input, doubt, cells, corners);
  each_cell([&](int column, int row) {
    const CellOf c = cell(column, row);
    const Rect rect = cell_rect(tile, column, row);
    const bool flat = is_flat(depth_m.row(rect.y0) + rect.x0, depth_m.stride, corners.depth_m, c);
    if (!flat || cells.change(c)) return each_pixel(rect);
    if (!cells.hide(c)) return;
    light_flat_past_people(lost, c, rect, light.background, light.visible);
  });
}

}  // namespace mixrig::render::cpu
