// SPDX-License-Identifier: Apache-2.0
#include "tests/stability/reference.h"

namespace mixrig::estimation_bench {
namespace {

using Matrix = std::vector<Reals>;

Matrix jacobian(const Residuals& residuals, const Reals& x) {
  const Real step("1e-17");  // the error of the central difference is 1e-34, its rounding 1e-33
  Matrix columns;
  for (std::size_t k = 0; k < x.size(); ++k) {
    Reals low = x, high = x;
    low[k] -= step;
    high[k] += step;
    const Reals a = residuals(low);
    Reals b = residuals(high);
    for (std::size_t i = 0; i < a.size(); ++i) b[i] = (b[i] - a[i]) / (2 * step);
    columns.push_back(std::move(b));
  }
  return columns;
}

Real dot(const Reals& a, const Reals& b) {
  Real sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

Matrix normal_matrix(const Matrix& columns) {
  Matrix n(columns.size(), Reals(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) n[i][j] = n[j][i] = dot(columns[i], columns[j]);
  return n;
}

/// Solves a x = b by Gauss-Jordan elimination with the largest pivot of each column.
Reals solve(Matrix a, Reals b) {
  const std::size_t n = b.size();
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < n; ++r)
      if (abs(a[r][c]) > abs(a[pivot][c])) pivot = r;
    std::swap(a[c], a[pivot]);
    std::swap(b[c], b[pivot]);
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c) continue;
      const Real factor = a[r][c] / a[c][c];
      for (std::size_t k = c; k < n; ++k) a[r][k] -= factor * a[c][k];
      b[r] -= factor * b[c];
    }
  }
  for (std::size_t c = 0; c < n; ++c) b[c] /= a[c][c];
  return b;
}

/// asin(s) / s as a function of s^2; by its series where s is small, which takes a tenth of the
/// time.
Real asin_ratio(const Real& s2) {
  if (s2 > Real("1e-3")) return asin(sqrt(s2)) / sqrt(s2);
  Real term = 1, sum = 1;
  for (int k = 1; term > Real("1e-52"); ++k) {
    term *= s2 * (2 * k - 1) / (2 * k);
    sum += term / (2 * k + 1);
  }
  return sum;
}

}  // namespace

Reals reals(const Eigen::Vector3d& v) { return {Real(v.x()), Real(v.y()), Real(v.z())}; }

Real length(const Reals& v) { return sqrt(dot(v, v)); }

Motion moved(const geometry::Pose& pose, const Reals& x, std::size_t at) {
  Real q[4] = {pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z()};
  const Real norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (Real& value : q) value /= norm;
  // The small rotation as a quaternion, by its series where the angle vanishes.
  const Real w2 = x[at] * x[at] + x[at + 1] * x[at + 1] + x[at + 2] * x[at + 2];
  const bool tiny = w2 < Real("1e-24");
  const Real half = sqrt(w2) / 2;
  const Real c = tiny ? 1 - w2 / 8 + w2 * w2 / 384 : cos(half);
  const Real s = tiny ? Real(0.5) - w2 / 48 + w2 * w2 / 3840 : sin(half) / (2 * half);
  const Real d[4] = {c, s * x[at], s * x[at + 1], s * x[at + 2]};
  const Real p[4] = {d[0] * q[0] - d[1] * q[1] - d[2] * q[2] - d[3] * q[3],
                     d[0] * q[1] + d[1] * q[0] + d[2] * q[3] - d[3] * q[2],
                     d[0] * q[2] - d[1] * q[3] + d[2] * q[0] + d[3] * q[1],
                     d[0] * q[3] + d[1] * q[2] - d[2] * q[1] + d[3] * q[0]};
  Motion m;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    m.r[i][i] = 1 - 2 * (p[1 + j] * p[1 + j] + p[1 + k] * p[1 + k]);
    m.r[i][j] = 2 * (p[1 + i] * p[1 + j] - p[0] * p[1 + k]);
    m.r[i][k] = 2 * (p[1 + i] * p[1 + k] + p[0] * p[1 + j]);
    m.t[i] = Real(pose.translation_m[i]) + x[at + 3 + i];
  }
  return m;
}

Motion moved_about(const geometry::Pose& pose, const Eigen::Vector3d& centre, const Reals& x) {
  const Reals none(6, Real(0));
  Reals turn = x;
  for (int k = 3; k < 6; ++k) turn[k] = 0;
  const Reals image = mapped(moved(pose, none), reals(centre));
  Motion m = moved(pose, turn);
  const Reals turned = mapped(m, reals(centre));
  for (int k = 0; k < 3; ++k) m.t[k] += image[k] - turned[k] + x[3 + k];
  return m;
}

Reals mapped(const Motion& m, const Reals& p) {
  Reals q(3);
  for (int i = 0; i < 3; ++i)
    q[i] = m.r[i][0] * p[0] + m.r[i][1] * p[1] + m.r[i][2] * p[2] + m.t[i];
  return q;
}

Reals mapped_back(const Motion& m, const Reals& p) {
  Reals q(3);
  for (int i = 0; i < 3; ++i)
    q[i] = m.r[0][i] * (p[0] - m.t[0]) + m.r[1][i] * (p[1] - m.t[1]) + m.r[2][i] * (p[2] - m.t[2]);
  return q;
}

Motion product(const Motion& first, const Motion& second) {
  Motion out;
  for (int i = 0; i < 3; ++i) {
    out.t[i] = first.t[i];
    for (int j = 0; j < 3; ++j) out.t[i] += first.r[i][j] * second.t[j];
    for (int k = 0; k < 3; ++k) {
      out.r[i][k] = 0;
      for (int j = 0; j < 3; ++j) out.r[i][k] += first.r[i][j] * second.r[j][k];
    }
  }
  return out;
}

void add_pose_residuals(const Motion& base_from_eye, const Motion& base_from_target,
                        const Motion& eye_from_target, const Real& sigma_rad, const Real& sigma_m,
                        Reals& residuals) {
  // off = predicted rotation * measured rotation^T, both of eye_from_target.
  Real predicted[3][3], off[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      predicted[i][k] = 0;
      for (int j = 0; j < 3; ++j)
        predicted[i][k] += base_from_eye.r[j][i] * base_from_target.r[j][k];
    }
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) {
      off[i][k] = 0;
      for (int j = 0; j < 3; ++j) off[i][k] += predicted[i][j] * eye_from_target.r[k][j];
    }
  const Real w[3] = {(off[2][1] - off[1][2]) / 2, (off[0][2] - off[2][0]) / 2,
                     (off[1][0] - off[0][1]) / 2};
  const Real gain = asin_ratio(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  for (const Real& value : w) residuals.push_back(gain * value / sigma_rad);
  const Reals centre = mapped_back(
      base_from_eye, {base_from_target.t[0], base_from_target.t[1], base_from_target.t[2]});
  for (int k = 0; k < 3; ++k) residuals.push_back((centre[k] - eye_from_target.t[k]) / sigma_m);
}

Eigen::MatrixXd cramer_rao(const Residuals& residuals, int parameters) {
  const Matrix n = normal_matrix(jacobian(residuals, Reals(parameters, Real(0))));
  Eigen::MatrixXd bound(parameters, parameters);
  for (int c = 0; c < parameters; ++c) {
    Reals unit(parameters, Real(0));
    unit[c] = 1;
    const Reals column = solve(n, unit);
    for (int r = 0; r < parameters; ++r) bound(r, c) = static_cast<double>(column[r]);
  }
  return bound;
}

Eigen::VectorXd minimum(const Residuals& residuals, int parameters) {
  Reals x(parameters, Real(0));
  for (int step = 0; step < 30; ++step) {
    const Matrix columns = jacobian(residuals, x);
    const Reals r = residuals(x);
    Reals gradient;
    for (const Reals& column : columns) gradient.push_back(dot(column, r));
    const Reals delta = solve(normal_matrix(columns), gradient);
    for (int k = 0; k < parameters; ++k) x[k] -= delta[k];
    if (length(delta) < Real("1e-22")) break;
  }
  Eigen::VectorXd result(parameters);
  for (int k = 0; k < parameters; ++k) result[k] = static_cast<double>(x[k]);
  return result;
}

}  // namespace mixrig::estimation_bench
