// SPDX-License-Identifier: Apache-2.0
#include "host/judge/measure/room_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "hal/base/order_statistics.h"

namespace mixrig::measure {
namespace {

using Vertex3 = std::array<double, 3>;
using Triangle3 = std::array<Vertex3, 3>;

double inner(const Vertex3& a, const Vertex3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vertex3 outer(const Vertex3& a, const Vertex3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vertex3 middle(const Vertex3& a, const Vertex3& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

/// The distance of the nearest triangle along the ray of each pixel; 0 where there is none.
class MeshDrawing {
 public:
  explicit MeshDrawing(Size size) : distance_m_(size) {
    for (int x = 0; x < size.width; ++x) {
      const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / size.width);
      columns_.push_back({-std::sin(azimuth), std::cos(azimuth)});
    }
    for (int y = 0; y < size.height; ++y) {
      const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / size.height);
      rows_.push_back({std::cos(elevation), std::sin(elevation)});
    }
  }

  /// Seen edges are arcs: triangles wider than a few degrees are halved until they are small.
  void add(const Triangle3& t, int depth = 0) {
    constexpr double kWide = 0.9976;  // cosine of 4 degrees
    constexpr int kMostHalvings = 24;
    std::size_t widest = 0;
    double least = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex3 &a = t[i], &b = t[(i + 1) % 3];
      const double cosine = inner(a, b) / std::sqrt(inner(a, a) * inner(b, b));
      if (cosine < least) least = cosine, widest = i;
    }
    if (least < kWide && depth < kMostHalvings) {
      const Vertex3 &a = t[widest], &b = t[(widest + 1) % 3], &c = t[(widest + 2) % 3];
      const Vertex3 m = middle(a, b);
      add({a, m, c}, depth + 1);
      add({m, b, c}, depth + 1);
      return;
    }
    draw(t);
  }
  const Image<float>& distance_m() const { return distance_m_; }

 private:
  void draw(const Triangle3& t) {
    const Size size = distance_m_.size();
    std::array<double, 3> u{}, v{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double azimuth = std::atan2(-t[i][0], t[i][1]);
      const double elevation = std::atan2(t[i][2], std::hypot(t[i][0], t[i][1]));
      u[i] = (1 - azimuth / std::numbers::pi) * 0.5 * size.width - 0.5;
      v[i] = (0.5 - elevation / std::numbers::pi) * size.height - 0.5;
      if (i > 0) u[i] -= size.width * std::round((u[i] - u[0]) / size.width);
    }
    const auto [left, right] = std::minmax({u[0], u[1], u[2]});
    const auto [top, bottom] = std::minmax({v[0], v[1], v[2]});
    for (int y = std::max(0, static_cast<int>(top) - 2);
         y <= std::min(size.height - 1, static_cast<int>(bottom) + 2); ++y)
      for (int x = static_cast<int>(left) - 3; x <= static_cast<int>(right) + 3; ++x)
        pixel(t, (x % size.width + size.width) % size.width, y);
  }

  void pixel(const Triangle3& t, int x, int y) {
    constexpr double kBorder = 1e-4;  // a ray along an edge meets both triangles
    const auto& column = columns_[static_cast<std::size_t>(x)];
    const auto& row = rows_[static_cast<std::size_t>(y)];
    const Vertex3 ray{row[0] * column[0], row[0] * column[1], row[1]};
    std::array<double, 3> part{};
    for (std::size_t i = 0; i < 3; ++i) part[i] = inner(ray, outer(t[(i + 1) % 3], t[(i + 2) % 3]));
    const double sum = part[0] + part[1] + part[2];
    if (sum == 0) return;
    for (double& p : part) {
      p /= sum;
      if (p < -kBorder) return;
    }
    double along_m = 0;
    for (std::size_t i = 0; i < 3; ++i) along_m += part[i] * inner(ray, t[i]);
    if (along_m <= 0) return;
    float& nearest_m = distance_m_.row(y)[x];
    if (nearest_m <= 0 || along_m < nearest_m) nearest_m = static_cast<float>(along_m);
  }

  Image<float> distance_m_;
  std::vector<std::array<double, 2>> columns_, rows_;
};

}  // namespace

MeshErrors mesh_errors(std::span<const float> positions_m, std::span<const std::uint32_t> indices,
                       ImageView<const float> distance_m) {
  MeshDrawing drawing(distance_m.size);
  const auto vertex = [&](std::uint32_t i) {
    const float* p = &positions_m[3 * static_cast<std::size_t>(i)];
    return Vertex3{p[0], p[1], p[2]};
  };
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    drawing.add({vertex(indices[i]), vertex(indices[i + 1]), vertex(indices[i + 2])});
  std::vector<float> off_mm;
  std::size_t known = 0;
  double sum_mm = 0;
  const int height = distance_m.size.height;
  for (int y = height / 4; y < height - height / 4; ++y)
    for (int x = 0; x < distance_m.size.width; ++x) {
      const float there_m = distance_m.row(y)[x], drawn_m = drawing.distance_m().row(y)[x];
      if (there_m <= 0) continue;
      ++known;
      if (drawn_m <= 0) continue;
      off_mm.push_back(1000 * std::abs(drawn_m - there_m));
      sum_mm += off_mm.back();
    }
  MeshErrors errors;
  if (known > 0)
    errors.uncovered_pct =
        100 * (1 - static_cast<double>(off_mm.size()) / static_cast<double>(known));
  if (off_mm.empty()) return errors;
  errors.mean_mm = sum_mm / static_cast<double>(off_mm.size());
  errors.p95_mm = order_statistic(std::span(off_mm), off_mm.size() * 95 / 100);
  errors.max_mm = *std::max_element(off_mm.begin(), off_mm.end());
  return errors;
}

}  // namespace mixrig::measure
