// SPDX-License-Identifier: Apache-2.0
#include "host/math/geometry/linear.h"

#include <gtest/gtest.h>

namespace mixrig::geometry {
namespace {

using Eigen::Vector3d;

Square6 positive_matrix() {
  Square6 a = Square6::Zero();
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) a(i, j) = 1.0 / (1 + i + j);
  return a + 0.1 * Square6::Identity();
}

TEST(Linear, SolvesSymmetricSystems) {
  const Square6 a = positive_matrix();
  Column6 x;
  x << 1, -2, 3, -4, 5, -6;
  const SymmetricSolver<6> solver(a);
  EXPECT_TRUE(solver.is_solved() && solver.is_positive());
  EXPECT_GT(solver.least_pivot(), 0);
  EXPECT_LT((solver.solve(a * x) - x).norm(), 1e-10);
  EXPECT_LT((solver.inverse() * a - Square6::Identity()).norm(), 1e-10);
  EXPECT_LT((inverse_of(a) * a - Square6::Identity()).norm(), 1e-10);
  const Cholesky6 cholesky(a);
  EXPECT_LT((cholesky.solve(a * x) - x).norm(), 1e-10);
  EXPECT_LT((cholesky.root() * cholesky.root().transpose() - a).norm(), 1e-12);
  EXPECT_FALSE(Cholesky6(-a).is_positive());
}

TEST(Linear, TellsWhereAPivotIsNotPositive) {
  const Eigen::Matrix3d a = Vector3d(2, -1, 3).asDiagonal();
  const SymmetricSolver<3> solver(a);
  EXPECT_FALSE(solver.is_positive());
  EXPECT_DOUBLE_EQ(solver.least_pivot(), -1);
  EXPECT_LT((solver.solve(Vector3d(2, -1, 3)) - Vector3d::Ones()).norm(), 1e-12);
}

TEST(Linear, TurnsOneDirectionIntoAnother) {
  const Vector3d from(1, 2, -0.5);
  for (const Vector3d& to : {Vector3d(0.3, -4, 2), Vector3d(2, 4, -1), Vector3d(-1, -2, 0.5),
                             Vector3d(-1, -2, 0.5 + 1e-9)}) {
    const Eigen::Quaterniond turn = rotation_between(from, to);
    EXPECT_NEAR(turn.norm(), 1, 1e-12);
    EXPECT_LT((turn * from.normalized() - to.normalized()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace mixrig::geometry
