// SPDX-License-Identifier: Apache-2.0
// Decompositions that the estimators share, compiled once: Eigen's take long to compile.
#pragma once

#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace mixrig::estimation {

/// Eigenvalues of a symmetric matrix in ascending order, and their unit eigenvectors as columns.
struct Spectrum {
  Eigen::Vector3d values;
  Eigen::Matrix3d axes;
};
Spectrum spectrum_of(const Eigen::Matrix3d& symmetric);

/// Eigenvalues of a symmetric 2x2 matrix in ascending order, and their unit eigenvectors as
/// columns.
struct PlanarSpectrum {
  Eigen::Vector2d values;
  Eigen::Matrix2d axes;
};
PlanarSpectrum planar_spectrum_of(const Eigen::Matrix2d& symmetric);

/// Eigenvalues of a symmetric matrix of any size in ascending order, and their unit eigenvectors as
/// columns.
struct DenseSpectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd axes;
};
DenseSpectrum dense_spectrum_of(const Eigen::MatrixXd& symmetric);

/// Solves A X = B for a symmetric A by LDL^T with pivoting; not finite where A is singular.
class SymmetricSolver {
 public:
  explicit SymmetricSolver(const Eigen::MatrixXd& symmetric);
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  Eigen::VectorXd solve_column(const Eigen::VectorXd& b) const;
  /// Least element of D; -1 where A could not be factorised.
  double least_pivot() const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> ldlt_;
};

/// Solves A X = B by LU with partial pivoting.
Eigen::MatrixXd solve_by_lu(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& a);

/// Singular value decomposition A = U diag(values) V^T, values in descending order.
struct SingularValues {
  Eigen::Matrix3d u, v;
  Eigen::Vector3d values;
};
SingularValues singular_values_of(const Eigen::Matrix3d& a);

/// Mean, root mean square spread along the principal axes (thinnest first), and these as columns.
struct PointSpread {
  Eigen::Vector3d mean_m, spread_m;
  Eigen::Matrix3d axes;
};
/// Returns the spread of the points named by `indices`, at least one. Loses no precision far from
/// the origin.
PointSpread spread_of(std::span<const Eigen::Vector3d> points_m, std::span<const int> indices);

/// The rotation that maximises trace(R^T cross); with cross = sum of w b a^T it is the
/// least-squares rotation b = R a (Arun 1987 with Umeyama's 1991 sign).
struct RotationFit {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d singular_values;  ///< of cross, in descending order
  bool mirrored;                    ///< the best orthogonal matrix is a reflection
};
RotationFit fit_rotation(const Eigen::Matrix3d& cross);

}  // namespace mixrig::estimation
