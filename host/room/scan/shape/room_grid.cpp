// SPDX-License-Identifier: Apache-2.0
// The panorama's pixels as a grid of triangles.
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/room/scan/shape/room_mesh.h"

namespace mixrig::model {
namespace {

constexpr std::uint32_t kNotMade = 0xFFFFFFFF;

bool holds_together(float a_m, float b_m) {
  const auto [low, high] = std::minmax(a_m, b_m);
  return low > 0 && !is_depth_step(low, high);
}

/// Builds the grid: vertices are made when a triangle first needs them. Column `width` is column 0
/// again with u above 1.
class GridMesh {
 public:
  explicit GridMesh(const Panorama& panorama) : panorama_(panorama), size_(panorama.size()) {
    vertices_.assign(
        (static_cast<std::size_t>(size_.width) + 1) * static_cast<std::size_t>(size_.height),
        kNotMade);
  }

  RoomMesh build() {
    for (int y = 0; y + 1 < size_.height; ++y)
      for (int x = 0; x < size_.width; ++x) add_quad(x, y);
    add_pole(0);
    add_pole(size_.height - 1);
    return std::move(mesh_);
  }

 private:
  struct Place {
    int x = 0, y = 0;
  };

  float distance_m(Place p) const { return panorama_.distance_m.row(p.y)[p.x % size_.width]; }

  std::uint32_t vertex(Place p) {
    const std::size_t at =
        static_cast<std::size_t>(p.y) * (static_cast<std::size_t>(size_.width) + 1) +
        static_cast<std::size_t>(p.x);
    if (vertices_[at] == kNotMade) {
      const Eigen::Vector3d ray = direction_of(size_, p.x % size_.width, p.y);
      vertices_[at] =
          add_vertex((ray * distance_m(p)).cast<float>(),
                     {(static_cast<float>(p.x) + 0.5F) / static_cast<float>(size_.width),
                      (static_cast<float>(p.y) + 0.5F) / static_cast<float>(size_.height)});
    }
    return vertices_[at];
  }

  std::uint32_t add_vertex(const Eigen::Vector3f& position_m, const Eigen::Vector2f& uv) {
    mesh_.positions_m.push_back(position_m), mesh_.uv.push_back(uv);
    return static_cast<std::uint32_t>(mesh_.positions_m.size() - 1);
  }

  void add_triangle(Place a, Place b, Place c) {
    const float a_m = distance_m(a), b_m = distance_m(b), c_m = distance_m(c);
    if (!holds_together(a_m, b_m) || !holds_together(b_m, c_m) || !holds_together(c_m, a_m)) return;
    for (const Place p : {a, b, c}) mesh_.indices.push_back(vertex(p));
  }

  /// Cut along the diagonal whose ends are closer in distance.
  void add_quad(int x, int y) {
    const Place a{x, y}, b{x + 1, y}, c{x, y + 1}, d{x + 1, y + 1};
    const auto gap_m = [&](Place p, Place q) {
      return distance_m(p) > 0 && distance_m(q) > 0 ? std::abs(distance_m(p) - distance_m(q))
                                                    : 1e9F;
    };
    if (gap_m(b, c) <= gap_m(a, d))
      add_triangle(a, c, b), add_triangle(b, c, d);
    else
      add_triangle(a, c, d), add_triangle(a, d, b);
  }

  /// A fan around the pole beside row `y`, where that row is known all around.
  void add_pole(int y) {
    double sum_m = 0;
    for (int x = 0; x < size_.width; ++x) {
      if (!holds_together(distance_m({x, y}), distance_m({x + 1, y}))) return;
      sum_m += distance_m({x, y});
    }
    const float up = y == 0 ? 1.0F : -1.0F;
    const std::uint32_t pole = add_vertex({0, 0, up * static_cast<float>(sum_m / size_.width)},
                                          {0.5F, y == 0 ? 0.0F : 1.0F});
    for (int x = 0; x < size_.width; ++x) {
      std::uint32_t left = vertex({x, y}), right = vertex({x + 1, y});
      if (y != 0) std::swap(left, right);
      mesh_.indices.insert(mesh_.indices.end(), {left, right, pole});
    }
  }

  const Panorama& panorama_;
  Size size_;
  std::vector<std::uint32_t> vertices_;
  RoomMesh mesh_;
};

}  // namespace

RoomMesh grid_mesh(const Panorama& panorama) { return GridMesh(panorama).build(); }

}  // namespace mixrig::model
