// SPDX-License-Identifier: Apache-2.0
// Meshes of a box whose distances have a formula, checked with rays (Moeller and Trumbore 1997).
#include "host/room/scan/shape/room_mesh.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

const Size kBoxSize{720, 360};
const double kBoxPixel_rad = M_PI / kBoxSize.height;

double to_box_m(const Vector3d& ray) {
  const Vector3d half_m(2.5, 2.0, 1.5);
  return half_m.cwiseQuotient(ray.cwiseAbs()).minCoeff();
}

/// A board 1 m ahead, 12 degrees to each side and up and down.
bool is_board(const Vector3d& ray) {
  return ray.y() > 0.5 && std::abs(ray.x() / ray.y()) < 0.2 && std::abs(ray.z() / ray.y()) < 0.2;
}

Panorama box(double noise_m, bool board = false) {
  Panorama p{
      Image<float>(kBoxSize), Image<float>(kBoxSize, static_cast<float>(std::max(noise_m, 0.004))),
      Image<std::uint8_t>(kBoxSize, 2), Image<std::uint8_t>(kBoxSize, 1), Image<Rgb8>(kBoxSize)};
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int y = 0; y < kBoxSize.height; ++y)
    for (int x = 0; x < kBoxSize.width; ++x) {
      const Vector3d ray = direction_of(kBoxSize, x, y);
      const double d_m = board && is_board(ray) ? 1 / ray.y() : to_box_m(ray);
      p.distance_m.at(x, y) = static_cast<float>(d_m + noise_m * normal(random));
    }
  return p;
}

RoomMesh reduced(const RoomMesh& grid, double tolerance_m) {
  Crew crew(2);
  return simplified(grid, kBoxSize, tolerance_m, crew);
}

struct RayHit {
  double distance_m = 0;
  Eigen::Vector2d uv;
};

/// The nearest triangle from the origin along a ray.
std::optional<RayHit> hit(const RoomMesh& mesh, const Vector3d& ray) {
  constexpr double kRim = 1e-6;
  std::optional<RayHit> nearest;
  const auto corner = [&](std::size_t i) {
    return Vector3d(mesh.positions_m[mesh.indices[i]].cast<double>());
  };
  const auto uv = [&](std::size_t i) {
    return Eigen::Vector2d(mesh.uv[mesh.indices[i]].cast<double>());
  };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vector3d a = corner(i), ab = corner(i + 1) - a, ac = corner(i + 2) - a;
    const Vector3d p = ray.cross(ac);
    const double det = ab.dot(p);
    if (det == 0) continue;
    const Vector3d q = (-a).cross(ab);
    const double s = -a.dot(p) / det, t = ray.dot(q) / det, along_m = ac.dot(q) / det;
    if (s < -kRim || t < -kRim || s + t > 1 + kRim || along_m <= 0) continue;
    if (!nearest || along_m < nearest->distance_m)
      nearest = {along_m, (1 - s - t) * uv(i) + s * uv(i + 1) + t * uv(i + 2)};
  }
  return nearest;
}

std::vector<Vector3d> random_rays(int count) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> rays{Vector3d::UnitZ(), -Vector3d::UnitZ()};
  while (static_cast<int>(rays.size()) < count)
    rays.push_back(Vector3d(normal(random), normal(random), normal(random)).normalized());
  return rays;
}

TEST(RoomMesh, HasFewTrianglesOnABoxAndNoGap) {
  const Panorama p = box(0);
  const RoomMesh grid = grid_mesh(p);
  EXPECT_EQ(grid.indices.size() / 3, 2U * 720 * 359 + 2 * 720);
  const double tolerance_m = mesh_tolerance_m(p);
  EXPECT_GE(tolerance_m, 0.0005);
  EXPECT_LE(tolerance_m, 0.002 + 1e-8);
  const RoomMesh mesh = reduced(grid, tolerance_m);
  EXPECT_LT(20 * mesh.indices.size(), grid.indices.size());
  for (const Vector3d& ray : random_rays(1000)) {
    const auto met = hit(mesh, ray);
    ASSERT_TRUE(met) << ray.transpose();
    // Edges of the box are cut off by up to a pixel.
    EXPECT_NEAR(met->distance_m, to_box_m(ray), 0.5 * kBoxPixel_rad * to_box_m(ray) + 0.002);
  }
}

TEST(RoomMesh, AddsLessThanAMillimetreToNoise) {
  const Panorama p = box(0.001);
  const RoomMesh grid = grid_mesh(p), mesh = reduced(grid, mesh_tolerance_m(p));
  double sum_m = 0;
  std::vector<double> off_m;
  for (int i = 0; i < 300; ++i) {  // rays through vertices of the grid
    const int x = 97 * i % kBoxSize.width, y = 1 + 61 * i % (kBoxSize.height - 2);
    const auto met = hit(mesh, direction_of(kBoxSize, x, y));
    ASSERT_TRUE(met);
    off_m.push_back(std::abs(met->distance_m - p.distance_m.at(x, y))), sum_m += off_m.back();
  }
  std::sort(off_m.begin(), off_m.end());
  EXPECT_LT(sum_m / 300, 0.001);
  EXPECT_LT(off_m[285], 0.003);
}

TEST(RoomMesh, SpansNoDepthStep) {
  const Panorama p = box(0, true);
  const RoomMesh mesh = reduced(grid_mesh(p), mesh_tolerance_m(p));
  int board = 0, wall = 0;
  for (int i = 0; i < 800; ++i) {
    const Vector3d ray = Vector3d(0.3 * std::sin(i), 1, 0.3 * std::cos(1.7 * i)).normalized();
    const auto met = hit(mesh, ray);
    if (!met) continue;  // the rim between the board and the wall
    const double ahead_m = met->distance_m * ray.y();
    if (std::abs(ahead_m - 1) < 0.003)
      ++board;
    else if (std::abs(ahead_m - 2) < 0.003)
      ++wall;
    else
      ADD_FAILURE() << "a surface at " << ahead_m << " m";
  }
  EXPECT_GT(board, 100);
  EXPECT_GT(wall, 100);
}

TEST(RoomMesh, TextureIsWithinThreePixelsAndNormalsFaceTheOrigin) {
  const Panorama p = box(0);
  const RoomMesh mesh = reduced(grid_mesh(p), mesh_tolerance_m(p));
  for (const Vector3d& ray : random_rays(1000)) {
    const auto met = hit(mesh, ray);
    ASSERT_TRUE(met);
    const double azimuth = M_PI * (1 - 2 * met->uv.x()), elevation = M_PI * (0.5 - met->uv.y());
    const Vector3d drawn(-std::sin(azimuth) * std::cos(elevation),
                         std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
    EXPECT_LT((drawn - ray).norm(), 3 * kBoxPixel_rad) << ray.transpose();
  }
  for (std::size_t v = 0; v < mesh.positions_m.size(); ++v) {
    EXPECT_NEAR(mesh.normals[v].norm(), 1, 1e-5);
    EXPECT_LT(mesh.normals[v].dot(mesh.positions_m[v]), 0);
  }
}

TEST(RoomMesh, OfNothingIsEmpty) {
  Panorama p = box(0);
  p.distance_m.fill(0);
  const RoomMesh grid = grid_mesh(p);
  EXPECT_TRUE(grid.indices.empty());
  EXPECT_TRUE(reduced(grid, 0.001).positions_m.empty());
}

}  // namespace
}  // namespace mixrig::model
