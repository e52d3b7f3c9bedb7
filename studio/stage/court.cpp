// SPDX-License-Identifier: Apache-2.0
#include "studio/stage/court.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "studio/sensors/noise.h"
#include "studio/stage/paint.h"

namespace mixrig::studio {
namespace {

using Vec2 = Eigen::Vector2f;
using Vec3 = Eigen::Vector3f;

constexpr Size kCourtTexture{256, 256};
constexpr float kWallX_m = 8.0F, kWallHigh_m = 2.6F, kTile_m = 1.2F;

/// Distance to the nearest joint between `count` stones along a side, of 1.
float joint(float u, float count) { return std::abs(u * count - std::round(u * count)) / count; }

Vec3 paving_color(float u, float v) {
  const float stone = fractal_noise({std::floor(u * 2) * 7.1F, std::floor(v * 2) * 5.3F}, 2, 41);
  const float grain = 0.85F + 0.3F * fractal_noise({u * 30, v * 30}, 3, 42);
  const float dark = std::min(joint(u, 2), joint(v, 2)) < 0.012F ? 0.45F : 1.0F;
  return dark * grain * (0.8F + 0.4F * stone) * Vec3(0.30F, 0.27F, 0.22F);
}

/// Courses of bricks, each shifted by half a brick.
Vec3 brick_color(float u, float v) {
  constexpr float kRows = 8, kColumns = 4;
  const float row = std::floor(v * kRows);
  const float shifted = u + 0.5F / kColumns * std::fmod(row, 2.0F);
  const float brick = fractal_noise({std::floor(shifted * kColumns) * 3.7F, row * 9.1F}, 2, 43);
  const bool mortar = joint(shifted, kColumns) < 0.01F || joint(v, kRows) < 0.008F;
  const float grain = 0.85F + 0.3F * fractal_noise({u * 40, v * 40}, 3, 44);
  return grain * (mortar ? Vec3(0.35F, 0.33F, 0.30F)
                         : Vec3((0.75F + 0.5F * brick) * Vec3(0.33F, 0.13F, 0.08F)));
}

Vec3 column_color(float u, float v) {
  return (0.8F + 0.3F * fractal_noise({u * 12, v * 25}, 4, 45)) * Vec3(0.55F, 0.50F, 0.40F);
}

/// A rectangle cut into squares of about a metre, so that none is much larger than it looks.
void add_plane(ObjectMesh& mesh, const Vec3& corner, const Vec3& a, const Vec3& b) {
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  const int columns = static_cast<int>(std::ceil(a.norm())),
            rows = static_cast<int>(std::ceil(b.norm()));
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(columns);
      const float t = static_cast<float>(j) / static_cast<float>(rows);
      mesh.positions_m.push_back(corner + s * a + t * b);
      mesh.normals.push_back(a.cross(b).normalized());
      mesh.uv.push_back({s * a.norm() / kTile_m, -t * b.norm() / kTile_m});
    }
  const auto row = static_cast<std::uint32_t>(columns + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j)
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t at = first + j * row + i;
      for (const std::uint32_t k : {at, at + 1, at + row + 1, at, at + row + 1, at + row})
        mesh.indices.push_back(k);
    }
}

/// An upright column with base and head, as rings of `kAround` vertices.
void add_column(ObjectMesh& mesh, float x, float y, float height) {
  constexpr int kAround = 24;
  const std::array<Vec2, 8> profile{{{0.30F, 0},
                                     {0.30F, 0.12F},
                                     {0.22F, 0.20F},
                                     {0.19F, 0.30F},
                                     {0.16F, height - 0.30F},
                                     {0.20F, height - 0.20F},
                                     {0.28F, height - 0.12F},
                                     {0.28F, height}}};
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  for (const Vec2& ring : profile)
    for (int i = 0; i <= kAround; ++i) {
      const float u = static_cast<float>(i) / kAround, angle = 2 * std::numbers::pi_v<float> * u;
      const Vec3 out(std::cos(angle), std::sin(angle), 0);
      mesh.positions_m.push_back(Vec3(x, y, ring.y()) + ring.x() * out);
      mesh.normals.push_back(out);
      mesh.uv.push_back({u, -ring.y()});
    }
  constexpr std::uint32_t kRow = kAround + 1;
  for (std::uint32_t j = 0; j + 1 < profile.size(); ++j)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const std::uint32_t at = first + j * kRow + i;
      for (const std::uint32_t k : {at, at + 1, at + kRow + 1, at, at + kRow + 1, at + kRow})
        mesh.indices.push_back(k);
    }
}

}  // namespace

VirtualObject build_court() {
  VirtualObject court;
  court.name = "court";
  ObjectMesh paving, walls, columns;
  add_plane(paving, {-4, -4, 0}, {12, 0, 0}, {0, 12, 0});
  paving.texture = paint(kCourtTexture, paving_color);
  // Seen from inside.
  add_plane(walls, {kWallX_m, 8, 0}, {0, -12, 0}, {0, 0, kWallHigh_m});
  add_plane(walls, {kWallX_m, -4, 0}, {-12, 0, 0}, {0, 0, kWallHigh_m});
  add_plane(walls, {-4, 8, 0}, {12, 0, 0}, {0, 0, kWallHigh_m});
  walls.texture = paint(kCourtTexture, brick_color);
  for (const float y : {-1.6F, 0.6F, 2.8F, 5.0F}) add_column(columns, 6.4F, y, 3.0F);
  columns.texture = paint(kCourtTexture, column_color);
  court.meshes = {std::move(paving), std::move(walls), std::move(columns)};
  return court;
}

Image<Rgb8> paint_sky(Size size) {
  return paint(size, [](float u, float v) {
    const float cloud = std::clamp(3 * fractal_noise({u * 5, v * 11}, 5, 46) - 1.4F, 0.0F, 1.0F);
    const Vec3 blue = (1 - v) * Vec3(0.10F, 0.24F, 0.55F) + v * Vec3(0.50F, 0.62F, 0.75F);
    return Vec3((1 - cloud) * blue + cloud * Vec3(0.8F, 0.8F, 0.8F));
  });
}

}  // namespace mixrig::studio
