// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include <LinearMath/btConvexHullComputer.h>

namespace mixrig::touch {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr float kWeld_m = 1e-4F;
constexpr float kSamePlane = 1e-4F;

/// Finds the connected part of each vertex; vertices at one place are welded.
class Parts {
 public:
  explicit Parts(const Triangles& mesh) : parent_(mesh.positions_m.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    std::map<std::array<long, 3>, std::uint32_t> first;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) {
      const Eigen::Vector3f p = mesh.positions_m[i] / kWeld_m;
      const auto at =
          first.try_emplace({std::lround(p.x()), std::lround(p.y()), std::lround(p.z())}, i).first;
      join(i, at->second);
    }
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
      for (const std::size_t k : {1, 2}) join(mesh.indices[t], mesh.indices[t + k]);
  }
  std::uint32_t of(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }

 private:
  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t p = of(a), q = of(b);
    parent_[std::max(p, q)] = std::min(p, q);
  }
  std::vector<std::uint32_t> parent_;
};

/// Points that are outermost in directions spread over the sphere (a Fibonacci lattice).
Points outermost(const Points& points) {
  if (points.size() <= kMostCorners) return points;
  std::vector<std::size_t> chosen;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < kMostCorners; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / kMostCorners;
    const double r = std::sqrt(1 - z * z), angle = turn * static_cast<double>(i);
    const Eigen::Vector3f d =
        Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
    const auto far =
        std::max_element(points.begin(), points.end(),
                         [&](const auto& a, const auto& b) { return a.dot(d) < b.dot(d); });
    chosen.push_back(static_cast<std::size_t>(far - points.begin()));
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  Points out;
  for (const std::size_t i : chosen) out.push_back(points[i]);
  return out;
}

void add_plane(const Plane& plane, std::vector<Plane>& planes) {
  const bool known = std::any_of(planes.begin(), planes.end(), [&](const Plane& p) {
    return p.normal.dot(plane.normal) > 1 - kSamePlane * kSamePlane &&
           std::abs(p.offset_m - plane.offset_m) < kSamePlane;
  });
  if (!known) planes.push_back(plane);
}

Convex box_part(const Eigen::AlignedBox3f& box_m) {
  Convex part;
  part.box_m = box_m;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3f normal = Eigen::Vector3f::Unit(axis);
    part.planes.push_back({normal, box_m.max()[axis]});
    part.planes.push_back({-normal, -box_m.min()[axis]});
  }
  for (int i = 0; i < 8; ++i)
    part.corners_m.push_back(box_m.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)));
  return part;
}

/// Replaces a flat part by its box, with the least thickness of a part.
Convex flat_part(const Points& points) {
  Eigen::AlignedBox3f box;
  for (const auto& p : points) box.extend(p);
  const Eigen::Vector3f more =
      (0.5F * (Eigen::Vector3f::Constant(kLeastThickness_m) - box.sizes())).cwiseMax(0.0F);
  return box_part({box.min() - more, box.max() + more});
}

/// Extent along the direction in which there is least; 0 for fewer than four places.
float thickness_m(const Convex& part) {
  float least = part.planes.size() < 4 ? 0 : std::numeric_limits<float>::max();
  for (const Plane& plane : part.planes) {
    float deepest = 0;
    for (const auto& p : part.corners_m)
      deepest = std::max(deepest, plane.offset_m - plane.normal.dot(p));
    least = std::min(least, deepest);
  }
  return least;
}

/// Lists the planes of each cell. Within a cell, the difference of two planes' distances changes by
/// the difference of their normals times the way from the cell's middle.
PlaneGrid grid_of(const Convex& part) {
  constexpr float kRounding_m = 1e-5F;
  constexpr int kCells = PlaneGrid::kCells;
  const Eigen::Vector3f size = part.box_m.sizes().array() + 2 * kNear_m;
  const Eigen::Vector3f cell = size / static_cast<float>(kCells);
  PlaneGrid grid{part.box_m.min().array() - kNear_m, cell.cwiseInverse(), {}, {}};
  std::vector<float> distances(part.planes.size());
  for (int i = 0; i < kCells * kCells * kCells; ++i) {
    const Eigen::Vector3f at(static_cast<float>(i % kCells),
                             static_cast<float>(i / kCells % kCells),
                             static_cast<float>(i / (kCells * kCells)));
    const Eigen::Vector3f middle =
        grid.corner_m + cell.cwiseProduct(at + Eigen::Vector3f::Constant(0.5F));
    for (std::size_t k = 0; k < distances.size(); ++k)
      distances[k] = part.planes[k].normal.dot(middle) - part.planes[k].offset_m;
    const auto most = std::max_element(distances.begin(), distances.end());
    const Eigen::Vector3f& normal =
        part.planes[static_cast<std::size_t>(most - distances.begin())].normal;
    grid.first.push_back(static_cast<std::uint32_t>(grid.planes.size()));
    for (std::size_t k = 0; k < distances.size(); ++k)
      if (distances[k] + 0.5F * cell.norm() * (part.planes[k].normal - normal).norm() +
              kRounding_m >=
          *most)
        grid.planes.push_back(static_cast<std::uint16_t>(k));
  }
  grid.first.push_back(static_cast<std::uint32_t>(grid.planes.size()));
  return grid;
}

Convex hull(const Points& all) {
  const Points points = outermost(all);
  btConvexHullComputer computer;
  computer.compute(points.data()->data(), sizeof(Eigen::Vector3f), static_cast<int>(points.size()),
                   0, 0);
  Convex part;
  for (int i = 0; i < computer.vertices.size(); ++i) {
    const btVector3& v = computer.vertices[i];
    part.corners_m.emplace_back(v.x(), v.y(), v.z());
    part.box_m.extend(part.corners_m.back());
  }
  const auto corner = [&](int i) { return part.corners_m[static_cast<std::size_t>(i)]; };
  for (int f = 0; f < computer.faces.size(); ++f) {
    // Newell's sum over the edges, so that short ones do not spoil the normal.
    Eigen::Vector3f sum = Eigen::Vector3f::Zero(), middle = Eigen::Vector3f::Zero();
    int count = 0;
    const btConvexHullComputer::Edge* const first = &computer.edges[computer.faces[f]];
    const btConvexHullComputer::Edge* edge = first;
    do {
      const Eigen::Vector3f a = corner(edge->getSourceVertex()),
                            b = corner(edge->getTargetVertex());
      sum += (a - corner(first->getSourceVertex())).cross(b - corner(first->getSourceVertex()));
      middle += a, ++count;
      edge = edge->getNextEdgeOfFace();
    } while (edge != first);
    if (sum.norm() < 1e-12F) continue;
    Eigen::Vector3f normal = sum.normalized();
    middle /= static_cast<float>(count);
    if (normal.dot(part.box_m.center() - middle) > 0) normal = -normal;
    add_plane({normal, normal.dot(middle)}, part.planes);
  }
  if (thickness_m(part) < kLeastThickness_m) return flat_part(points);
  constexpr std::size_t kMany = 24;
  if (part.planes.size() > kMany) part.grid = grid_of(part);
  return part;
}

std::vector<Points> parts_of(const Triangles& mesh, float scale) {
  Parts parts(mesh);
  std::map<std::uint32_t, Points> points;
  std::vector<bool> used(mesh.positions_m.size(), false);
  for (const std::uint32_t i : mesh.indices) used[i] = true;
  for (std::uint32_t i = 0; i < used.size(); ++i)
    if (used[i]) points[parts.of(i)].push_back(scale * mesh.positions_m[i]);
  std::vector<Points> out;
  for (auto& [part, places] : points) out.push_back(std::move(places));
  if (out.size() <= kMostParts) return out;
  for (std::size_t i = 1; i < out.size(); ++i)
    out[0].insert(out[0].end(), out[i].begin(), out[i].end());
  out.resize(1);
  return out;
}

}  // namespace

std::span<const std::uint16_t> PlaneGrid::near(const Eigen::Vector3f& p) const {
  const Eigen::Vector3f at = (p - corner_m).cwiseProduct(cells_per_m);
  if (first.empty() || !(at.minCoeff() >= 0 && at.maxCoeff() < static_cast<float>(kCells)))
    return {};
  const auto cell = static_cast<std::size_t>(
      (static_cast<int>(at.z()) * kCells + static_cast<int>(at.y())) * kCells +
      static_cast<int>(at.x()));
  return {planes.data() + first[cell], planes.data() + first[cell + 1]};
}

float Convex::distance_m(const Eigen::Vector3f& p, Eigen::Vector3f& normal) const {
  float most = -std::numeric_limits<float>::max();
  const auto look_at = [&](const Plane& plane) {
    if (const float d = plane.normal.dot(p) - plane.offset_m; d > most)
      most = d, normal = plane.normal;
  };
  const auto few = grid.near(p);
  for (const std::uint16_t number : few) look_at(planes[number]);
  if (few.empty()) std::for_each(planes.begin(), planes.end(), look_at);
  return most;
}

float Shape::distance_m(const Eigen::Vector3f& p, Eigen::Vector3f& normal) const {
  float least = std::numeric_limits<float>::max();
  for (const Convex& part : parts) {
    if (part.box_m.squaredExteriorDistance(p) > std::max(0.0F, least) * std::max(0.0F, least))
      continue;
    Eigen::Vector3f n = Eigen::Vector3f::UnitZ();
    if (const float d = part.distance_m(p, n); d < least) least = d, normal = n;
  }
  return least;
}

Shape make_shape(std::span<const Triangles> meshes, double scale) {
  Shape shape;
  for (const Triangles& mesh : meshes)
    for (const Points& points : parts_of(mesh, static_cast<float>(scale)))
      shape.parts.push_back(hull(points));
  for (const Convex& part : shape.parts) shape.box_m.extend(part.box_m);
  return shape;
}

Shape box_shape(const Eigen::AlignedBox3f& box_m) { return {{box_part(box_m)}, box_m}; }

}  // namespace mixrig::touch
