// SPDX-License-Identifier: Apache-2.0
// A board under a Gaussian footprint.
#include "host/calibrate/rig/board_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mixrig::calibration {
namespace {

constexpr int kMostCells = 12;

/// A function of one variable with its first two derivatives.
struct Smooth {
  double value = 0, first = 0, second = 0;
  Smooth operator-(const Smooth& o) const {
    return {value - o.value, first - o.first, second - o.second};
  }
  void add(double factor, const Smooth& o) {
    value += factor * o.value, first += factor * o.first, second += factor * o.second;
  }
};

/// A step from 0 to 1 at zero, seen through a Gaussian.
Smooth step(double x, double sigma) {
  const double z = x / sigma;
  if (z > 6) return {1, 0, 0};
  if (z < -6) return {0, 0, 0};
  const double density = std::exp(-0.5 * z * z) / (sigma * std::sqrt(2 * std::numbers::pi));
  return {0.5 * std::erfc(-z * std::numbers::sqrt2 / 2), density, -z / sigma * density};
}

/// Squares along one axis: `inside` is 1 from the first line to the last, `sign` +1 and -1 in turn.
struct Lines {
  Smooth inside, sign;
};

Lines lines_of(double x, double sigma, int squares) {
  Lines lines;
  const int reach = 1 + static_cast<int>(6 * sigma), nearest = static_cast<int>(std::lround(x));
  const int first = std::clamp(nearest - reach, 0, squares + 1);
  const int last = std::clamp(nearest + reach, -1, squares);
  lines.inside.value = first > 0 && first <= squares ? 1 : 0;
  lines.sign.value = first > 0 && first <= squares ? (first % 2 == 1 ? 1 : -1) : 0;
  for (int k = first; k <= last; ++k) {
    const Smooth rise = step(x - k, sigma);
    const double turn = k % 2 == 0 ? 1 : -1, end = k == 0 || k == squares ? 1 : 2;
    lines.sign.add(end * turn, rise);
    if (k == 0) lines.inside.add(1, rise);
    if (k == squares) lines.inside.add(-1, rise);
  }
  return lines;
}

/// Adds factor * a(u) b(v) with the correlation of u and v.
void add_product(InkShare& share, double factor, const Smooth& a, const Smooth& b, double cross) {
  share.ink += factor * (a.value * b.value + cross * a.first * b.first);
  share.d_uv.x() += factor * (a.first * b.value + cross * a.second * b.first);
  share.d_uv.y() += factor * (a.value * b.first + cross * a.first * b.second);
}

/// The square that holds (u, v), or none of a marker.
const std::uint8_t* marker_at(const BoardPrint& print, const Eigen::Vector2d& uv, int& column,
                              int& row) {
  column = static_cast<int>(std::floor(uv.x())), row = static_cast<int>(std::floor(uv.y()));
  if (print.marker_cells == 0 || column < 0 || row < 0 || column >= print.columns ||
      row >= print.rows || is_black(print, column, row))
    return nullptr;
  const auto id = static_cast<std::size_t>((row * print.columns + column) / 2);
  const auto cells = static_cast<std::size_t>(print.marker_cells * print.marker_cells);
  return (id + 1) * cells <= print.ink.size() ? &print.ink[id * cells] : nullptr;
}

void add_marker(InkShare& share, const BoardPrint& print, const Eigen::Vector2d& uv,
                const Eigen::Vector2d& sigma, double cross) {
  int column = 0, row = 0;
  const std::uint8_t* ink = marker_at(print, uv, column, row);
  if (ink == nullptr) return;
  const int n = std::min(print.marker_cells, kMostCells);
  const double border = 0.5 * (1 - print.marker), cell = print.marker / n;
  std::array<Smooth, kMostCells + 1> u, v;
  for (int k = 0; k <= n; ++k) {
    u[k] = step(uv.x() - column - border - k * cell, sigma.x());
    v[k] = step(uv.y() - row - border - k * cell, sigma.y());
  }
  for (int j = 0; j < n; ++j) {
    // Runs of ink in a row of cells are one box.
    for (int i = 0; i < n;) {
      const int from = i;
      while (i < n && ink[j * n + i] != 0) ++i;
      if (i > from) add_product(share, 1, u[from] - u[i], v[j] - v[j + 1], cross);
      if (i == from) ++i;
    }
  }
}

}  // namespace

InkShare ink_under(const BoardPrint& print, const Eigen::Vector2d& uv,
                   const Eigen::Matrix2d& footprint) {
  const Eigen::Vector2d sigma = footprint.diagonal().cwiseSqrt();
  const double cross = footprint(0, 1);
  const Lines u = lines_of(uv.x(), sigma.x(), print.columns);
  const Lines v = lines_of(uv.y(), sigma.y(), print.rows);
  InkShare share;
  add_product(share, 0.5, u.inside, v.inside, cross);
  add_product(share, print.first_is_white ? -0.5 : 0.5, u.sign, v.sign, cross);
  add_marker(share, print, uv, sigma, cross);
  return share;
}

bool is_plain(const BoardPrint& print, const Eigen::Vector2d& uv, const Eigen::Vector2d& reach,
              double& ink) {
  const auto near_line = [](double x, double r) { return std::abs(x - std::round(x)) < r; };
  if (near_line(uv.x(), reach.x()) || near_line(uv.y(), reach.y())) return false;
  int column = 0, row = 0;
  const std::uint8_t* cells = marker_at(print, uv, column, row);
  const bool inside = column >= 0 && row >= 0 && column < print.columns && row < print.rows;
  ink = inside && is_black(print, column, row) ? 1 : 0;
  if (cells == nullptr) return true;
  const double border = 0.5 * (1 - print.marker);
  const double u = (uv.x() - column - border) / print.marker,
               v = (uv.y() - row - border) / print.marker;
  const double ru = reach.x() / print.marker, rv = reach.y() / print.marker;
  if (u < -ru || v < -rv || u > 1 + ru || v > 1 + rv) return true;  // outside the marker
  if (u < ru || v < rv || u > 1 - ru || v > 1 - rv) return false;
  const int n = print.marker_cells;
  if (near_line(u * n, ru * n) || near_line(v * n, rv * n)) return false;
  ink = cells[static_cast<int>(v * n) * n + static_cast<int>(u * n)];
  return true;
}

}  // namespace mixrig::calibration
