// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/shape/room_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

#include <meshoptimizer.h>

#include "hal/base/order_statistics.h"

namespace mixrig::model {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr std::uint32_t kNoVertex = 0xFFFFFFFF;
Vector3f direction_of_uv(const Vector2f& uv) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float azimuth = kPi * (1 - 2 * uv.x()), elevation = kPi * (0.5F - uv.y());
  return {-std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

/// Texture coordinates of a direction; u lies within half a turn of `near_u`.
Vector2f uv_of(const Vector3f& p, float near_u) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float u = 0.5F * (1 - std::atan2(-p.x(), p.y()) / kPi);
  const float v = 0.5F - std::atan2(p.z(), std::hypot(p.x(), p.y())) / kPi;
  return {u + std::round(near_u - u), v};
}

/// Halves edges on which linear texture coordinates are more than a pixel off. An edge is judged
/// by its ends alone, so that both its triangles agree.
class TextureSplit {
 public:
  TextureSplit(RoomMesh& mesh, Size panorama)
      : mesh_(mesh), pixel_rad_(std::numbers::pi_v<float> / static_cast<float>(panorama.height)) {}

  void run() {
    constexpr int kMostPasses = 12;
    for (int pass = 0; pass < kMostPasses && split_once(); ++pass) {
    }
  }

 private:
  bool split_once() {
    middles_.clear();
    std::vector<std::uint32_t> indices;
    indices.reserve(mesh_.indices.size());
    for (std::size_t i = 0; i < mesh_.indices.size(); i += 3)
      split_triangle({mesh_.indices[i], mesh_.indices[i + 1], mesh_.indices[i + 2]}, indices);
    const bool changed = indices.size() != mesh_.indices.size();
    mesh_.indices = std::move(indices);
    return changed;
  }

  void split_triangle(std::array<std::uint32_t, 3> corner, std::vector<std::uint32_t>& out) {
    std::array<std::uint32_t, 3> middle{};  // of the edge from corner i to i + 1
    for (std::size_t i = 0; i < 3; ++i) middle[i] = middle_of(corner[i], corner[(i + 1) % 3]);
    const auto count =
        std::count_if(middle.begin(), middle.end(), [](auto m) { return m != kNoVertex; });
    const auto turn = [&] {
      std::rotate(corner.begin(), corner.begin() + 1, corner.end());
      std::rotate(middle.begin(), middle.begin() + 1, middle.end());
    };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      out.insert(out.end(), {a, b, c});
    };
    if (count == 0) return add(corner[0], corner[1], corner[2]);
    if (count == 3) {
      for (std::size_t i = 0; i < 3; ++i) add(corner[i], middle[i], middle[(i + 2) % 3]);
      return add(middle[0], middle[1], middle[2]);
    }
    if (count == 1) {
      while (middle[0] == kNoVertex) turn();
      add(corner[0], middle[0], corner[2]);
      return add(middle[0], corner[1], corner[2]);
    }
    while (middle[2] != kNoVertex) turn();
    add(middle[0], corner[1], middle[1]);
    add(corner[0], middle[0], middle[1]);
    add(corner[0], middle[1], corner[2]);
  }

  std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | b;
    const auto [found, is_new] = middles_.try_emplace(key, kNoVertex);
    if (!is_new) return found->second;
    if (texture_off_rad(a, b) <= pixel_rad_) return kNoVertex;
    const Vector3f middle_m = 0.5F * (mesh_.positions_m[a] + mesh_.positions_m[b]);
    const float u = 0.5F * (mesh_.uv[a].x() + mesh_.uv[b].x());
    mesh_.positions_m.push_back(middle_m);
    mesh_.uv.push_back(uv_of(middle_m, u));
    return found->second = static_cast<std::uint32_t>(mesh_.positions_m.size() - 1);
  }

  /// The largest of three places along an edge.
  float texture_off_rad(std::uint32_t a, std::uint32_t b) const {
    float off_rad = 0;
    for (const float part : {0.25F, 0.5F, 0.75F}) {
      const Vector3f at_m = (1 - part) * mesh_.positions_m[a] + part * mesh_.positions_m[b];
      const Vector2f linear = (1 - part) * mesh_.uv[a] + part * mesh_.uv[b];
      off_rad = std::max(off_rad, (direction_of_uv(linear) - at_m.normalized()).norm());
    }
    return off_rad;
  }

  RoomMesh& mesh_;
  float pixel_rad_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;
};

/// The vertices that `indices` use, in order of use.
RoomMesh compact(const RoomMesh& mesh, std::vector<std::uint32_t> indices) {
  std::vector<std::uint32_t> place(mesh.positions_m.size(), kNoVertex);
  RoomMesh out;
  for (std::uint32_t& index : indices) {
    if (place[index] == kNoVertex) {
      place[index] = static_cast<std::uint32_t>(out.positions_m.size());
      out.positions_m.push_back(mesh.positions_m[index]), out.uv.push_back(mesh.uv[index]);
    }
    index = place[index];
  }
  out.indices = std::move(indices);
  return out;
}

/// The triangles of each sector of azimuth.
std::vector<std::vector<std::uint32_t>> sectors_of(const RoomMesh& grid) {
  constexpr int kSectors = 8;
  std::vector<std::vector<std::uint32_t>> sectors(kSectors);
  for (std::size_t i = 0; i < grid.indices.size(); i += 3) {
    const float u = grid.uv[grid.indices[i]].x();
    const int sector = std::clamp(static_cast<int>(u * kSectors), 0, kSectors - 1);
    const auto first = grid.indices.begin() + static_cast<std::ptrdiff_t>(i);
    auto& part = sectors[static_cast<std::size_t>(sector)];
    part.insert(part.end(), first, first + 3);
  }
  return sectors;
}

/// Triangles of `mesh` with edges collapsed, as indices of its vertices.
std::vector<std::uint32_t> collapsed(const RoomMesh& mesh,
                                     const std::vector<std::uint32_t>& indices, double tolerance_m,
                                     unsigned options) {
  if (indices.empty()) return {};
  std::vector<std::uint32_t> used(indices), place(mesh.positions_m.size());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<Vector3f> positions_m;
  for (const std::uint32_t v : used) {
    place[v] = static_cast<std::uint32_t>(positions_m.size());
    positions_m.push_back(mesh.positions_m[v]);
  }
  std::vector<std::uint32_t> local(indices.size()), out(indices.size());
  std::transform(indices.begin(), indices.end(), local.begin(), [&](auto v) { return place[v]; });
  const float* positions = positions_m.front().data();
  const float extent_m = meshopt_simplifyScale(positions, positions_m.size(), sizeof(Vector3f));
  out.resize(meshopt_simplify(out.data(), local.data(), local.size(), positions, positions_m.size(),
                              sizeof(Vector3f), 0, static_cast<float>(tolerance_m) / extent_m,
                              options, nullptr));
  std::transform(out.begin(), out.end(), out.begin(), [&](auto v) { return used[v]; });
  return out;
}

/// Mean of the normals of a vertex's triangles by their area, of those that face the origin: others
/// are slivers that a collapse folded over. Towards the origin where none is left.
void add_normals(RoomMesh& mesh) {
  mesh.normals.assign(mesh.positions_m.size(), Vector3f::Zero());
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto [a, b, c] = std::array{mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
    const Vector3f edge_m = mesh.positions_m[b] - mesh.positions_m[a];
    const Vector3f normal = edge_m.cross(mesh.positions_m[c] - mesh.positions_m[a]);
    if (normal.dot(mesh.positions_m[a]) >= 0) continue;
    for (const auto v : {a, b, c}) mesh.normals[v] += normal;
  }
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    const Vector3f to_origin = -mesh.positions_m[v].normalized(),
                   unit = mesh.normals[v].normalized();
    mesh.normals[v] = unit.dot(to_origin) > 0 ? unit : to_origin;
  }
}

}  // namespace

double mesh_tolerance_m(const Panorama& panorama) {
  constexpr float kNoiseShare = 1.25F, kPixelShare = 0.25F, kMost_m = 0.002F;
  const float pixel_rad = std::numbers::pi_v<float> / static_cast<float>(panorama.size().height);
  std::vector<float> tolerance_m;
  for (int y = 0; y < panorama.size().height; ++y)
    for (int x = 0; x < panorama.size().width; ++x)
      if (panorama.views.row(y)[x] > 0)
        tolerance_m.push_back(
            std::min({kNoiseShare * panorama.sigma_m.row(y)[x],
                      kPixelShare * pixel_rad * panorama.distance_m.row(y)[x], kMost_m}));
  return tolerance_m.empty() ? kMost_m : upper_median_in_place(std::span(tolerance_m));
}

RoomMesh simplified(const RoomMesh& grid, Size panorama, double tolerance_m, Crew& crew) {
  constexpr double kPartShare = 0.6, kWholeShare = 0.8;  // of the tolerance: squares add up to one
  std::vector<std::vector<std::uint32_t>> parts = sectors_of(grid);
  crew.rows(static_cast<int>(parts.size()), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      auto& part = parts[static_cast<std::size_t>(i)];
      part = collapsed(grid, part, kPartShare * tolerance_m, meshopt_SimplifyLockBorder);
    }
  });
  std::vector<std::uint32_t> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  RoomMesh mesh = compact(grid, collapsed(grid, all, kWholeShare * tolerance_m, 0));
  TextureSplit(mesh, panorama).run();
  add_normals(mesh);
  return mesh;
}

}  // namespace mixrig::model
