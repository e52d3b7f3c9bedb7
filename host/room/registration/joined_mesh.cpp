// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/joined_mesh.h"

#include <algorithm>

#include "host/room/registration/places.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

constexpr double kJoinedGate_m = 0.02;

/// Middle of a triangle, its normal away from the origin, and sigma there.
struct GridTriangle {
  Vector3d middle_m, normal;
};

GridTriangle triangle_of(const RoomMesh& grid, std::size_t first) {
  const auto corner = [&](std::size_t i) -> Vector3d {
    return grid.positions_m[grid.indices[first + i]].cast<double>();
  };
  const Vector3d a = corner(0), b = corner(1), c = corner(2);
  Vector3d normal = (b - a).cross(c - a).normalized();
  const Vector3d middle_m = (a + b + c) / 3;
  if (normal.dot(middle_m) < 0) normal = -normal;
  return {middle_m, normal};
}

/// Whether part `other` sees the triangle of part `own` better.
bool sees_better(const std::vector<JoinedPart>& parts, std::size_t own, std::size_t other,
                 const GridTriangle& triangle) {
  const Seen at_home = look(*parts[own].panorama, triangle.middle_m, triangle.normal, 0, 1);
  const double sigma_m = at_home.sight == RoomSight::kAgrees ? at_home.sigma_m : 0;
  const geometry::Pose pose =
      geometry::inverse(parts[other].first_from_base) * parts[own].first_from_base;
  const Seen there = look(*parts[other].panorama, pose * triangle.middle_m,
                          pose.rotation * triangle.normal, sigma_m, kJoinedGate_m);
  if (there.sight != RoomSight::kAgrees) return false;
  if (at_home.sight != RoomSight::kAgrees) return true;  // at a grazing angle
  const double own_m = at_home.sigma_m / at_home.incidence;
  const double other_m = there.sigma_m / there.incidence;
  return other < own ? other_m <= own_m : other_m < own_m;
}

}  // namespace

std::vector<RoomMesh> joined_grids(const std::vector<JoinedPart>& parts, Crew& crew) {
  std::vector<RoomMesh> grids;
  for (std::size_t own = 0; own < parts.size(); ++own) {
    RoomMesh grid = grid_mesh(*parts[own].panorama);
    const std::size_t triangles = grid.indices.size() / 3;
    std::vector<std::uint8_t> drop(triangles, 0);
    crew.rows(static_cast<int>(triangles), 4096, [&](int begin, int end) {
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
        const GridTriangle triangle = triangle_of(grid, 3 * i);
        for (std::size_t other = 0; other < parts.size() && drop[i] == 0; ++other)
          if (other != own && sees_better(parts, own, other, triangle)) drop[i] = 1;
      }
    });
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < triangles; ++i)
      if (drop[i] == 0)
        kept.insert(kept.end(), grid.indices.begin() + static_cast<std::ptrdiff_t>(3 * i),
                    grid.indices.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
    grid.indices = std::move(kept);
    grids.push_back(std::move(grid));
  }
  return grids;
}

void place(const geometry::Pose& first_from_base, RoomMesh& mesh) {
  const Eigen::Matrix3f turn = first_from_base.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f shift_m = first_from_base.translation_m.cast<float>();
  for (auto& p : mesh.positions_m) p = (turn * p + shift_m).eval();
  for (auto& n : mesh.normals) n = (turn * n).eval();
}

}  // namespace mixrig::model
