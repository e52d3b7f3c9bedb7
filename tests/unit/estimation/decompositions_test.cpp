// SPDX-License-Identifier: Apache-2.0
// The closed form for 2x2 matrices against Eigen's iterative solver and against known answers.
#include "host/math/estimation/decompositions.h"

#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

namespace mixrig::estimation {
namespace {

Eigen::Matrix2d symmetric(double a, double b, double off) {
  Eigen::Matrix2d m;
  m << a, off, off, b;
  return m;
}

TEST(PlanarSpectrum, AgreesWithTheIterativeSolver) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> scale(-6, 6), value(-1, 1);
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Matrix2d m =
        std::pow(10.0, scale(random)) * symmetric(value(random), value(random), value(random));
    const PlanarSpectrum ours = planar_spectrum_of(m);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> theirs(m);
    const double bound = 4e-15 * m.norm();
    EXPECT_LE((ours.values - theirs.eigenvalues()).cwiseAbs().maxCoeff(), bound) << m;
    EXPECT_LE((m * ours.axes - ours.axes * ours.values.asDiagonal()).norm(), bound) << m;
    EXPECT_LE((ours.axes.transpose() * ours.axes - Eigen::Matrix2d::Identity()).norm(), 1e-15 * 4);
  }
}

TEST(PlanarSpectrum, OfDiagonalDoubleAndZeroMatricesIsExact) {
  EXPECT_EQ(planar_spectrum_of(symmetric(3, 1, 0)).values, Eigen::Vector2d(1, 3));
  EXPECT_EQ(planar_spectrum_of(symmetric(1, 3, 0)).values, Eigen::Vector2d(1, 3));
  EXPECT_EQ(planar_spectrum_of(symmetric(2, 2, 0)).values, Eigen::Vector2d(2, 2));
  EXPECT_EQ(planar_spectrum_of(symmetric(0, 0, 0)).values, Eigen::Vector2d(0, 0));
  EXPECT_EQ(planar_spectrum_of(symmetric(0, 0, 2)).values, Eigen::Vector2d(-2, 2));
  const Eigen::Matrix2d axes = planar_spectrum_of(symmetric(0, 0, 0)).axes;
  EXPECT_EQ(axes.cwiseAbs().sum(), 2);  // still unit axes
}

}  // namespace
}  // namespace mixrig::estimation
