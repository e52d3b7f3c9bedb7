// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/decompositions.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace mixrig::estimation {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Spectrum spectrum_of(const Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

PlanarSpectrum planar_spectrum_of(const Eigen::Matrix2d& symmetric) {
  const double half = (symmetric(0, 0) - symmetric(1, 1)) / 2, off = symmetric(1, 0);
  const double mean = symmetric.trace() / 2, spread = std::hypot(half, off);
  const double turn_rad = std::atan2(off, half) / 2, c = std::cos(turn_rad), s = std::sin(turn_rad);
  Eigen::Matrix2d axes;
  axes << -s, c, c, s;
  return {{mean - spread, mean + spread}, axes};
}

DenseSpectrum dense_spectrum_of(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricSolver::SymmetricSolver(const Eigen::MatrixXd& symmetric) : ldlt_(symmetric) {}

Eigen::MatrixXd SymmetricSolver::solve(const Eigen::MatrixXd& b) const { return ldlt_.solve(b); }

Eigen::VectorXd SymmetricSolver::solve_column(const Eigen::VectorXd& b) const {
  return ldlt_.solve(b);
}

double SymmetricSolver::least_pivot() const {
  return ldlt_.info() == Eigen::Success ? ldlt_.vectorD().minCoeff() : -1;
}

Eigen::MatrixXd solve_by_lu(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.partialPivLu().solve(b);
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& a) { return a.inverse(); }

SingularValues singular_values_of(const Matrix3d& a) {
  const Eigen::JacobiSVD<Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.matrixV(), svd.singularValues()};
}

PointSpread spread_of(std::span<const Vector3d> points_m, std::span<const int> indices) {
  const auto count = static_cast<double>(indices.size());
  const Vector3d first = points_m[indices[0]];
  Vector3d mean = Vector3d::Zero();
  for (int i : indices) mean += points_m[i] - first;
  mean = first + mean / count;
  Matrix3d scatter = Matrix3d::Zero();
  for (int i : indices) scatter += (points_m[i] - mean) * (points_m[i] - mean).transpose();
  const Spectrum spectrum = spectrum_of(scatter / count);
  return {mean, spectrum.values.cwiseMax(0).cwiseSqrt(), spectrum.axes};
}

RotationFit fit_rotation(const Matrix3d& cross) {
  const SingularValues svd = singular_values_of(cross);
  const bool mirrored = svd.u.determinant() * svd.v.determinant() < 0;
  const Vector3d sign(1, 1, mirrored ? -1 : 1);
  const Matrix3d rotation = svd.u * sign.asDiagonal() * svd.v.transpose();
  return {Eigen::Quaterniond(rotation).normalized(), svd.values, mirrored};
}

}  // namespace mixrig::estimation
