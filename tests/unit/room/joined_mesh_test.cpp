// SPDX-License-Identifier: Apache-2.0
// Meshes of one box seen from two places: what both see is in one of them.
#include "host/room/registration/joined_mesh.h"

#include <cmath>

#include <gtest/gtest.h>

#include "hal/base/angles.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

constexpr Size kJoinedSize{720, 360};
const Vector3d kJoinedBox_m(5, 4, 3);  ///< from the origin to this corner

Panorama box_seen_from(const Vector3d& at_m, float sigma_m, double least_azimuth = -10) {
  Panorama p;
  p.distance_m.reset(kJoinedSize), p.views.reset(kJoinedSize, 2), p.field.reset(kJoinedSize, 1);
  p.sigma_m.reset(kJoinedSize, sigma_m), p.color.reset(kJoinedSize);
  for (int y = 0; y < kJoinedSize.height; ++y)
    for (int x = 0; x < kJoinedSize.width; ++x) {
      const Vector3d ray = direction_of(kJoinedSize, x, y);
      double d_m = 1e9;
      for (int k = 0; k < 3; ++k)
        d_m = std::min(d_m, ((ray[k] > 0 ? kJoinedBox_m[k] : 0) - at_m[k]) / ray[k]);
      const bool known = std::atan2(-ray.x(), ray.y()) > least_azimuth;
      p.distance_m.at(x, y) = known ? static_cast<float>(d_m) : 0;
    }
  return p;
}

geometry::Pose shifted(const Vector3d& by_m) { return {Eigen::Quaterniond::Identity(), by_m}; }

/// Area of the triangles, in the axes of the first room.
double area_m2(const RoomMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto at = [&](std::size_t k) { return mesh.positions_m[mesh.indices[i + k]]; };
    sum += 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
  }
  return sum;
}

const Vector3d kFirst_m(1.5, 2.4, 1.4), kSecond_m(3.3, 1.6, 1.2);

TEST(JoinedMesh, WhatBothSeeIsThereOnce) {
  const Panorama a = box_seen_from(kFirst_m, 0.002F), b = box_seen_from(kSecond_m, 0.002F);
  Crew crew(2);
  const auto grids = joined_grids({{&a, {}}, {&b, shifted(kSecond_m - kFirst_m)}}, crew);
  ASSERT_EQ(grids.size(), 2U);
  const double alone_m2 = area_m2(grid_mesh(a));
  EXPECT_NEAR(alone_m2, 2 * (5 * 4 + 5 * 3 + 4 * 3), 5);
  // Where one ends and the other begins, triangles overlap by up to one.
  EXPECT_NEAR(area_m2(grids[0]) + area_m2(grids[1]), alone_m2, 0.1 * alone_m2);
  // Each room keeps the surfaces that it sees from nearer and more directly.
  EXPECT_GT(area_m2(grids[0]), 0.3 * alone_m2);
  EXPECT_GT(area_m2(grids[1]), 0.3 * alone_m2);
}

TEST(JoinedMesh, TheSurerRoomHasWhatBothSee) {
  const Panorama a = box_seen_from(kFirst_m, 0.05F), b = box_seen_from(kSecond_m, 0.001F);
  Crew crew(2);
  const auto grids = joined_grids({{&a, {}}, {&b, shifted(kSecond_m - kFirst_m)}}, crew);
  EXPECT_LT(area_m2(grids[0]), 0.1 * area_m2(grids[1]));
}

TEST(JoinedMesh, WhatOneAloneSeesStays) {
  const Panorama a = box_seen_from(kFirst_m, 0.05F), b = box_seen_from(kSecond_m, 0.001F, 0);
  Crew crew(2);
  const auto grids = joined_grids({{&a, {}}, {&b, shifted(kSecond_m - kFirst_m)}}, crew);
  const double whole_m2 = area_m2(grid_mesh(a)), half_m2 = area_m2(grid_mesh(b));
  EXPECT_NEAR(area_m2(grids[0]), whole_m2 - half_m2, 0.05 * whole_m2);
  EXPECT_NEAR(area_m2(grids[1]), half_m2, 0.01 * whole_m2);
}

// Texture coordinates are those of the room's own picture: they point along the vertex's ray.
TEST(JoinedMesh, TexturesStayWithTheirRoomWhereItIsPlaced) {
  const Panorama a = box_seen_from(kFirst_m, 0.002F), b = box_seen_from(kSecond_m, 0.002F);
  Crew crew(1);
  geometry::Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(50 * kDeg, Vector3d::UnitZ())),
                      {0.3, -0.2, 0.1}};
  auto grids = joined_grids({{&a, {}}, {&b, shifted(kSecond_m - kFirst_m)}}, crew);
  RoomMesh placed = grids[1];
  place(pose, placed);
  EXPECT_EQ(placed.uv, grids[1].uv);
  EXPECT_EQ(placed.indices, grids[1].indices);
  int checked = 0;
  for (const std::uint32_t i : placed.indices) {
    const Vector3d own = geometry::inverse(pose) * placed.positions_m[i].cast<double>();
    const double v = 0.5 - std::asin(own.normalized().z()) / kPi;
    if (std::abs(v - 0.5) > 0.45) continue;  // fans of the poles
    const double u = (kPi - std::atan2(-own.x(), own.y())) / (2 * kPi);
    EXPECT_NEAR(placed.uv[i].y(), v, 1e-3);
    EXPECT_NEAR(std::remainder(placed.uv[i].x() - u, 1), 0, 1e-3);
    if (++checked == 2000) break;
  }
  EXPECT_GT(checked, 1000);
}

}  // namespace
}  // namespace mixrig::model
