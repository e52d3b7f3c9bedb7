// SPDX-License-Identifier: Apache-2.0
// Pass light: cells of 8x8 pixels of a tile, and interpolation between values at their corners.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/render/cpu/light/light_parts.h"

namespace mixrig::render::cpu {

inline constexpr int kCellPx = 8;
inline constexpr int kCellsAcross = kLitTileWidth / kCellPx, kCellsDown = kLitTileHeight / kCellPx;
/// Largest change over a cell, of a lamp's share or of light, that is interpolated: more than a tap
/// of a filter.
inline constexpr float kMostChange = 0.1F;
/// Largest relative difference between a depth in a cell and the plane through its corners.
inline constexpr float kFlatPart = 0.01F;

inline constexpr std::size_t kCornersPadded =
    ((kCellsAcross + 1) * (kCellsDown + 1) + kLanes - 1) / kLanes * kLanes;
/// Values at the corners of a tile's cells, in row order.
struct alignas(64) CornerValues : std::array<float, kCornersPadded> {};

/// Index of a corner.
constexpr std::size_t corner(int column, int row) {
  return static_cast<std::size_t>(row * kCellsAcross + row + column);
}

/// Corner indices of a cell: upper left, upper right, lower left, lower right.
struct CellOf {
  std::size_t a, b, c, d;
};
constexpr CellOf cell(int column, int row) {
  return {corner(column, row), corner(column + 1, row), corner(column, row + 1),
          corner(column + 1, row + 1)};
}
inline Rect cell_rect(const Rect& tile, int column, int row) {
  const int x0 = tile.x0 + column * kCellPx, y0 = tile.y0 + row * kCellPx;
  return {x0, y0, std::min(x0 + kCellPx, tile.x1), std::min(y0 + kCellPx, tile.y1)};
}

/// Largest difference between a cell's corners.
inline float change_over(const CornerValues& v, const CellOf& c) {
  const auto [least, most] = std::minmax({v[c.a], v[c.b], v[c.c], v[c.d]});
  return most - least;
}

/// What hidden lamps change over a cell, to find those that must be looked up pixel by pixel.
class LampChanges {
 public:
  /// Precondition: at most kMostLamps.
  void add(std::size_t lamp, float change) { changes_[count_++] = {change, lamp}; }
  /// Lamps without which the remaining ones, and `other`, change by at most kMostChange together.
  LampSet too_large(float other = 0) {
    std::sort(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(count_));
    LampSet set = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      other += changes_[i].first;
      if (other > kMostChange) set |= LampSet{1} << changes_[i].second;
    }
    return set;
  }

 private:
  std::array<std::pair<float, std::size_t>, kMostLamps> changes_;
  std::size_t count_ = 0;
};

/// Between the corners of a cell, at each of its pixels: `visit(x, y, value)`.
template <typename Visit>
void between(const CornerValues& v, const CellOf& c, Visit&& visit) {
  for (int y = 0; y < kCellPx; ++y) {
    const float down = static_cast<float>(y) / kCellPx;
    const float left = v[c.a] + (v[c.c] - v[c.a]) * down;
    const float step = (v[c.b] + (v[c.d] - v[c.b]) * down - left) / kCellPx;
    for (int x = 0; x < kCellPx; ++x) visit(x, y, left + step * static_cast<float>(x));
  }
}
/// Interpolates at positions `across` and `down` of the cell's sides, 0..1.
inline FloatLanes between(const CornerValues& v, const CellOf& c, FloatLanes across,
                          FloatLanes down) {
  const FloatLanes left = v[c.a] + (v[c.c] - v[c.a]) * down;
  const FloatLanes right = v[c.b] + (v[c.d] - v[c.b]) * down;
  return left + (right - left) * across;
}

/// Whether the values of a cell's pixels, the first at `from`, lie on the plane of its corners, all
/// of which must be positive.
inline bool is_flat(const float* from, std::ptrdiff_t stride, const CornerValues& v,
                    const CellOf& c) {
  if (!(v[c.a] > 0 && v[c.b] > 0 && v[c.c] > 0 && v[c.d] > 0)) return false;
  bool flat = true;
  between(v, c, [&](int x, int y, float value) {
    flat &= std::abs(from[y * stride + x] - value) <= kFlatPart * value;
  });
  return flat;
}

/// Calls visit(column, row) for each cell of a tile.
template <typename Visit>
void each_cell(Visit&& visit) {
  for (int row = 0; row < kCellsDown; ++row)
    for (int column = 0; column < kCellsAcross; ++column) visit(column, row);
}

/// Calls visit(number, x, y) for each corner of a tile, with (x, y) clamped to the view.
template <typename Visit>
void each_corner(const Rect& tile, Size view, Visit&& visit) {
  for (int row = 0; row <= kCellsDown; ++row)
    for (int column = 0; column <= kCellsAcross; ++column)
      visit(corner(column, row), std::min(tile.x0 + column * kCellPx, view.width - 1),
            std::min(tile.y0 + row * kCellPx, view.height - 1));
}

/// Whether the blur of every lamp in `maybe` is wider than a cell; else a narrow shadow could lie
/// between corners.
bool blur_allows_cells(const PinholeParams& view, const std::vector<LampParams>& lamps,
                       const std::vector<ShadowMap>& maps, LampSet maybe, const Rect& tile,
                       float near_m, float far_m);

}  // namespace mixrig::render::cpu
