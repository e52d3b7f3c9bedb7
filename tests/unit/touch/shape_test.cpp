// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/shape.h"

#include <array>
#include <random>

#include <gtest/gtest.h>

#include "extras/people/touch/shape_gap.h"
#include "tests/unit/touch/touch_shapes.h"

namespace mixrig::touch {
namespace {

float distance(const Shape& shape, const Eigen::Vector3f& p) {
  Eigen::Vector3f normal;
  return shape.distance_m(p, normal);
}

TEST(Shape, ABoxHasSixPlanesAndItsDistances) {
  TestMesh mesh;
  add_box(mesh, {Eigen::Vector3f(-0.5F, -0.25F, 0), Eigen::Vector3f(0.5F, 0.25F, 1)});
  const Shape shape = make_shape(std::array{mesh.triangles()}, 2.0);
  ASSERT_EQ(shape.parts.size(), 1U);
  EXPECT_EQ(shape.parts[0].planes.size(), 6U);
  EXPECT_NEAR(distance(shape, {0, 0, 1}), -0.5F, 1e-5);  // scaled: 2 x 1 x 2 m
  EXPECT_NEAR(distance(shape, {0.9F, 0, 1}), -0.1F, 1e-5);
  EXPECT_NEAR(distance(shape, {1.3F, 0, 1}), 0.3F, 1e-5);
  EXPECT_NEAR(distance(shape, {0, 0, 2.2F}), 0.2F, 1e-5);
  Eigen::Vector3f normal;
  shape.distance_m({0, 0.7F, 1}, normal);
  EXPECT_NEAR((normal - Eigen::Vector3f::UnitY()).norm(), 0, 1e-5);
}

TEST(Shape, PartsOfAMeshStayApart) {
  TestMesh mesh;
  add_box(mesh, {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(1, 1, 1)});
  add_box(mesh, {Eigen::Vector3f(3, 0, 0), Eigen::Vector3f(4, 1, 1)});
  const Shape shape = make_shape(std::array{mesh.triangles()}, 1.0);
  ASSERT_EQ(shape.parts.size(), 2U);
  EXPECT_NEAR(distance(shape, {2, 0.5F, 0.5F}), 1, 1e-5);  // between them
  EXPECT_NEAR(shape.box_m.sizes().x(), 4, 1e-5);
}

TEST(Shape, ABallOfManyCornersKeepsItsSurface) {
  const TestMesh mesh = ball_mesh(0.5F);
  const Shape shape = make_shape(std::array{mesh.triangles()}, 1.0);
  ASSERT_EQ(shape.parts.size(), 1U);
  EXPECT_LE(shape.parts[0].corners_m.size(), kMostCorners);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f d =
        Eigen::Vector3f(normal(random), normal(random), normal(random)).normalized();
    EXPECT_NEAR(distance(shape, 0.5F * d), 0, 0.015);
    EXPECT_NEAR(distance(shape, 0.4F * d), -0.1, 0.015);
  }
}

TEST(Shape, WhatIsFlatGetsThickness) {
  TestMesh mesh;
  mesh.positions_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  const Shape shape = make_shape(std::array{mesh.triangles()}, 1.0);
  ASSERT_EQ(shape.parts.size(), 1U);
  EXPECT_NEAR(distance(shape, {0.5F, 0.5F, 0}), -0.5F * kLeastThickness_m, 1e-6);
  EXPECT_TRUE(make_shape({}, 1).parts.empty());
}

TEST(ShapeGap, BoxesByFormula) {
  const Shape box = box_shape({Eigen::Vector3f(-0.5F, -0.5F, 0), Eigen::Vector3f(0.5F, 0.5F, 1)});
  const auto at = [](double x) {
    return geometry::Pose{Eigen::Quaterniond::Identity(), {x, 0.1, 0}};
  };
  const auto apart = shape_gap(box, at(0), box, at(1.2));
  ASSERT_TRUE(apart);
  EXPECT_NEAR(apart->m, 0.2, 1e-3);
  EXPECT_NEAR(apart->at_m.x(), 0.6, 2e-3);
  const auto inside = shape_gap(box, at(0), box, at(0.93));
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->m, -0.07, 2e-3);
  EXPECT_FALSE(shape_gap(box, at(0), box, at(2)));
}

TEST(ShapeGap, TheRoomByFormula) {
  const Shape box = box_shape({Eigen::Vector3f(-0.5F, -0.5F, 0), Eigen::Vector3f(0.5F, 0.5F, 1)});
  std::vector<plan::RoomPoint> wall;
  for (float y = -1; y < 1; y += 0.02F)
    for (float z = 0; z < 2; z += 0.02F) wall.push_back({{0.4F, y, z}, {}});
  const auto gap = room_gap(box, {}, wall);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->m, -0.1, 1e-3);
  const auto off = room_gap(box, {Eigen::Quaterniond::Identity(), {-0.2, 0, 0}}, wall);
  ASSERT_TRUE(off);
  EXPECT_NEAR(off->m, 0.1, 1e-3);
  EXPECT_FALSE(room_gap(box, {}, std::vector<plan::RoomPoint>(3)));
}

TEST(Shape, ACellKnowsItsFarthestFaces) {
  const TestMesh mesh = ball_mesh(0.4F);
  const Shape ball = make_shape(std::array{mesh.triangles()}, 1);
  Convex slow = ball.parts[0];
  ASSERT_GT(slow.planes.size(), 200U);
  ASSERT_FALSE(slow.grid.first.empty());
  slow.grid = {};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> anywhere(-0.7F, 0.7F);
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3f p(anywhere(random), anywhere(random), anywhere(random));
    Eigen::Vector3f normal, slow_normal;
    const float d = ball.parts[0].distance_m(p, normal);
    EXPECT_NEAR(d, slow.distance_m(p, slow_normal), 0);
    EXPECT_EQ(normal, slow_normal);
    EXPECT_NEAR(d, p.norm() - 0.4F, 0.01F);
  }
}

}  // namespace
}  // namespace mixrig::touch
