// SPDX-License-Identifier: Apache-2.0
#include "extras/map/reconstruction/views/five_point.h"

#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

namespace mixrig::reconstruction {
namespace {

/// Exponents of x, y, z of the monomials up to degree 3; those of degree 3 first.
struct Monomial {
  int x, y, z;
};
constexpr std::array<Monomial, 20> kMonomials{
    {{3, 0, 0}, {2, 1, 0}, {2, 0, 1}, {1, 2, 0}, {1, 1, 1}, {1, 0, 2}, {0, 3, 0},
     {0, 2, 1}, {0, 1, 2}, {0, 0, 3}, {2, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 2, 0},
     {0, 1, 1}, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};

constexpr std::size_t index_of(const Monomial& m) {
  for (std::size_t i = 0; i < kMonomials.size(); ++i)
    if (kMonomials[i].x == m.x && kMonomials[i].y == m.y && kMonomials[i].z == m.z) return i;
  return kMonomials.size();
}

/// A polynomial of degree 3 at most.
using Polynomial = Eigen::Matrix<double, 20, 1>;

constexpr std::array<std::array<std::size_t, 20>, 20> products() {
  std::array<std::array<std::size_t, 20>, 20> table{};
  for (std::size_t i = 0; i < 20; ++i)
    for (std::size_t j = 0; j < 20; ++j)
      table[i][j] = index_of({kMonomials[i].x + kMonomials[j].x, kMonomials[i].y + kMonomials[j].y,
                              kMonomials[i].z + kMonomials[j].z});
  return table;
}
constexpr auto kProducts = products();

/// Precondition: the degrees add up to 3 at most.
Polynomial times(const Polynomial& a, const Polynomial& b) {
  Polynomial out = Polynomial::Zero();
  for (std::size_t i = 0; i < 20; ++i) {
    const double factor = a[static_cast<Eigen::Index>(i)];
    if (factor == 0) continue;
    for (std::size_t j = 0; j < 20; ++j) {
      const double other = b[static_cast<Eigen::Index>(j)];
      if (other != 0) out[static_cast<Eigen::Index>(kProducts[i][j])] += factor * other;
    }
  }
  return out;
}

using PolynomialMatrix = std::array<std::array<Polynomial, 3>, 3>;
using Matrix10 = Eigen::Matrix<double, 10, 10>;

/// The ten cubic equations, a row each.
Eigen::Matrix<double, 10, 20> constraints_of(const PolynomialMatrix& e) {
  Eigen::Matrix<double, 10, 20> rows;
  PolynomialMatrix square;  // E E^T
  Polynomial trace = Polynomial::Zero();
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      square[i][j].setZero();
      for (std::size_t k = 0; k < 3; ++k) square[i][j] += times(e[i][k], e[j][k]);
      if (i == j) trace += square[i][j];
    }
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      Polynomial p = -times(trace, e[i][j]);
      for (std::size_t k = 0; k < 3; ++k) p += 2 * times(square[i][k], e[k][j]);
      rows.row(row++) = p.transpose();
    }
  Polynomial det = Polynomial::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
    det += times(e[0][k], times(e[1][l], e[2][m]) - times(e[1][m], e[2][l]));
  }
  rows.row(row) = det.transpose();
  return rows;
}

/// Multiplication by x of the monomials of degree 2 at most.
Matrix10 action_matrix(const Matrix10& reduced) {
  Matrix10 action = Matrix10::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) action.row(i) = -reduced.row(i);
  action(6, 0) = action(7, 1) = action(8, 2) = action(9, 6) = 1;
  return action;
}

}  // namespace

std::vector<Eigen::Matrix3d> essential_of_five(const std::array<Eigen::Vector3d, 5>& a,
                                               const std::array<Eigen::Vector3d, 5>& b) {
  Eigen::Matrix<double, 5, 9> rays;
  for (std::size_t k = 0; k < 5; ++k)
    for (int i = 0; i < 3; ++i)
      rays.block<1, 3>(static_cast<Eigen::Index>(k), 3 * i) = b[k][i] * a[k].transpose();
  const Eigen::JacobiSVD<Eigen::Matrix<double, 5, 9>, Eigen::FullPivHouseholderQRPreconditioner>
      svd(rays, Eigen::ComputeFullV);
  if (svd.singularValues()[4] < 1e-9) return {};
  const Eigen::Matrix<double, 9, 4> null = svd.matrixV().rightCols<4>();
  PolynomialMatrix e;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      e[i][j].setZero();
      e[i][j].tail<4>() = null.row(static_cast<Eigen::Index>(3 * i + j)).transpose();
    }
  const Eigen::Matrix<double, 10, 20> rows = constraints_of(e);
  const Eigen::FullPivLU<Matrix10> cubic(rows.leftCols<10>());
  if (!cubic.isInvertible()) return {};
  const Matrix10 reduced = cubic.solve(rows.rightCols<10>());
  const Eigen::EigenSolver<Matrix10> eigen(action_matrix(reduced));
  std::vector<Eigen::Matrix3d> solutions;
  if (eigen.info() != Eigen::Success) return solutions;
  for (Eigen::Index s = 0; s < 10; ++s) {
    if (std::abs(eigen.eigenvalues()[s].imag()) > 1e-9) continue;
    const Eigen::Matrix<double, 10, 1> v = eigen.eigenvectors().col(s).real();
    if (std::abs(v[9]) < 1e-12) continue;
    const Eigen::Matrix<double, 9, 1> flat =
        null * Eigen::Vector4d(v[6] / v[9], v[7] / v[9], v[8] / v[9], 1);
    Eigen::Matrix3d matrix;
    for (int i = 0; i < 3; ++i) matrix.row(i) = flat.segment<3>(3 * i).transpose();
    if (matrix.allFinite() && matrix.norm() > 0) solutions.push_back(matrix / matrix.norm());
  }
  return solutions;
}

}  // namespace mixrig::reconstruction
