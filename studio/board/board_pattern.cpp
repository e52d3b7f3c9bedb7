// SPDX-License-Identifier: Apache-2.0
// The studio's calibration board.
#include "studio/board/board_pattern.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

namespace mixrig::studio {
namespace {

constexpr int kMarkerCells = 6;  ///< four bits and a black border on both sides
constexpr std::array<std::uint16_t, 50> kMarkers{
    0xB532, 0x0F9A, 0x332D, 0x9946, 0x549E, 0x79CD, 0x9E2E, 0xC4F2, 0xFEDA, 0xCF56,
    0xF991, 0x11A7, 0x0EB7, 0x2A0F, 0x24B1, 0x263E, 0x4665, 0x6600, 0x6C5E, 0x76AF,
    0x868B, 0xB02B, 0xCCD5, 0xDD82, 0xFE47, 0x9471, 0xACE4, 0xA554, 0x2123, 0x346F,
    0x4415, 0x57B2, 0x9ECF, 0xF0CB, 0x08AE, 0x0929, 0x1875, 0x04FF, 0x0DF6, 0x1C5A,
    0x1718, 0x2A28, 0x328C, 0x38B2, 0x24E8, 0x2EEB, 0x2D3F, 0x4B64, 0x502E, 0x5013};

}  // namespace

std::string_view name(BoardKind kind) {
  return kind == BoardKind::kCheckerboard ? "checkerboard" : "charuco";
}

Result<BoardKind> parse_board(std::string_view text) {
  for (const BoardKind kind : {BoardKind::kCheckerboard, BoardKind::kCharuco})
    if (name(kind) == text) return kind;
  return Error{ErrorCode::kUsage,
               fmt::format("unknown board '{}': use one of checkerboard, charuco", text)};
}

double board_w_m(const BoardPlan& plan, double u_m) {
  const double x = 2 * u_m / plan.width_m() - 1;
  return -plan.bend_m * (1 - x * x);
}

std::span<const std::uint16_t> marker_bits() { return kMarkers; }

bool BoardPattern::marker_white(int column, int row, float u, float v) const {
  const double cell = plan_.marker_m / plan_.square_m / kMarkerCells;
  const double border = 0.5 * (1 - plan_.marker_m / plan_.square_m);
  const int i = static_cast<int>(std::floor((u - border) / cell));
  const int j = static_cast<int>(std::floor((v - border) / cell));
  if (i < 0 || j < 0 || i >= kMarkerCells || j >= kMarkerCells) return true;
  if (i == 0 || j == 0 || i == kMarkerCells - 1 || j == kMarkerCells - 1) return false;
  // White squares are counted row by row; rows start alternately with black and white.
  const int id = (row * plan_.columns + column) / 2;
  return (kMarkers[static_cast<std::size_t>(id)] >> (15 - 4 * (j - 1) - (i - 1)) & 1) != 0;
}

bool BoardPattern::white(float u_m, float v_m) const {
  const auto square = static_cast<float>(plan_.square_m);
  const float u = u_m / square, v = v_m / square;
  const int column = static_cast<int>(std::floor(u)), row = static_cast<int>(std::floor(v));
  if (column < 0 || row < 0 || column >= plan_.columns || row >= plan_.rows) return true;
  if ((column + row) % 2 == 0) return false;
  if (plan_.kind == BoardKind::kCheckerboard) return true;
  return marker_white(column, row, u - static_cast<float>(column), v - static_cast<float>(row));
}

std::optional<float> BoardPattern::crossing(float at_m, float half_m, int squares) const {
  const auto square = static_cast<float>(plan_.square_m);
  const float low = (at_m - half_m) / square, high = (at_m + half_m) / square;
  const float nearest = std::round(0.5F * (low + high));
  if (nearest >= 0 && nearest <= static_cast<float>(squares) && low <= nearest && nearest <= high)
    return nearest * square;
  if (plan_.kind == BoardKind::kCheckerboard) return std::nullopt;
  const auto cell = static_cast<float>(plan_.marker_m / plan_.square_m / kMarkerCells);
  const float border = 0.5F - 0.5F * kMarkerCells * cell, base = std::floor(0.5F * (low + high));
  for (int k = 0; k <= kMarkerCells; ++k) {
    const float line = base + border + static_cast<float>(k) * cell;
    if (low <= line && line <= high) return line * square;
  }
  return std::nullopt;
}

float BoardPattern::white_share(float u_m, float v_m, float half_u_m, float half_v_m) const {
  struct Part {
    float at, share;
  };
  const auto parts = [&](float at, float half, int squares) -> std::array<Part, 2> {
    const auto line = crossing(at, half, squares);
    if (!line) return {{{at, 1}, {at, 0}}};
    const float low = at - half, high = at + half;
    return {{{0.5F * (low + *line), (*line - low) / (2 * half)},
             {0.5F * (*line + high), (high - *line) / (2 * half)}}};
  };
  float share = 0;
  for (const Part& u : parts(u_m, half_u_m, plan_.columns))
    for (const Part& v : parts(v_m, half_v_m, plan_.rows))
      if (u.share > 0 && v.share > 0 && white(u.at, v.at)) share += u.share * v.share;
  return share;
}

bool BoardPattern::is_one_color(float u_m, float v_m, float half_u_m, float half_v_m) const {
  return !crossing(u_m, half_u_m, plan_.columns) && !crossing(v_m, half_v_m, plan_.rows);
}

Mesh build_board(const BoardPlan& plan) {
  const int across = plan.bend_m == 0 ? 1 : 96;
  const double margin = plan.margin_m(), left = -margin, width = plan.width_m() + 2 * margin;
  Mesh mesh;
  for (int i = 0; i <= across; ++i) {
    const double u = left + width * i / across;
    for (const double v : {-margin, plan.height_m() + margin}) {
      const double slope = plan.bend_m * (2 * u / plan.width_m() - 1) * 4 / plan.width_m();
      mesh.positions.emplace_back(Eigen::Vector3d(u, v, board_w_m(plan, u)).cast<float>());
      mesh.normals.emplace_back(Eigen::Vector3d(slope, 0, -1).normalized().cast<float>());
      mesh.uv.emplace_back(Eigen::Vector2d(u, v).cast<float>());
    }
    if (i == 0) continue;
    const auto k = static_cast<std::uint32_t>(2 * i);
    for (const std::uint32_t index : {k - 2, k - 1, k, k, k - 1, k + 1})
      mesh.indices.push_back(index);
    mesh.materials.insert(mesh.materials.end(), 2, Material{Kind::kPaint});
  }
  return mesh;
}

}  // namespace mixrig::studio
