// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/multilateration.h"

#include <cmath>
#include <string>

#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/linear_fit.h"
#include "host/math/estimation/small_solve.h"

namespace mixrig::estimation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Points = std::span<const Vector3d>;

/// A fitted position with its information, and the solution on the other side of the centres'
/// plane.
struct RangeFix {
  Vector3d position;
  Matrix3d information;  // for unit weight
  double cost;           // sum of squared range residuals, m^2
  std::optional<Vector3d> mirror;
  double mirror_cost = 0;
};

/// Not whitened: residuals in units of `scale_m`, and so is x (from `start`).
struct RangeResiduals {
  Points centres;
  std::span<const double> ranges;
  std::span<const int> indices;
  Vector3d start;
  double scale_m;

  int NumResiduals() const { return static_cast<int>(indices.size()); }
  template <typename T>
  bool operator()(const T* x, T* residuals) const {
    int row = 0;
    for (int i : indices) {
      const Vector3d arm = (start - centres[i]) / scale_m;
      const T dx = x[0] + arm.x(), dy = x[1] + arm.y(), dz = x[2] + arm.z();
      residuals[row++] = sqrt(dx * dx + dy * dy + dz * dz) - ranges[i] / scale_m;
    }
    return true;
  }
};

/// The squared range equations less their mean: 2 (c - mean)^T y = |c - mean|^2 - d^2 - mean(..),
/// y relative to the frame's origin. Solved in `dimensions` widest axes.
Vector3d linear_start(Points centres, std::span<const double> ranges, std::span<const int> indices,
                      const PointSpread& frame, int dimensions) {
  const auto n = static_cast<Eigen::Index>(indices.size());
  Eigen::MatrixXd a(n, dimensions);
  Eigen::VectorXd b(n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const Vector3d c = frame.axes.transpose() * (centres[indices[row]] - frame.mean_m);
    a.row(row) = 2 * c.tail(dimensions).transpose();
    b[row] = c.squaredNorm() - ranges[indices[row]] * ranges[indices[row]];
  }
  b.array() -= b.mean();
  Vector3d y = Vector3d::Zero();
  y.tail(dimensions) = solve_linear(a, b).x;
  return y;
}

/// Starts in frame axes: on both sides of the centres' plane, and the full linear solution.
std::vector<Vector3d> starts_of(Points centres, std::span<const double> ranges,
                                std::span<const int> indices, const PointSpread& frame) {
  Vector3d flat = linear_start(centres, ranges, indices, frame, 2);
  double height2 = 0;
  for (int i : indices) {
    const Vector3d c = frame.axes.transpose() * (centres[i] - frame.mean_m);
    height2 += ranges[i] * ranges[i] - (c - flat).tail<2>().squaredNorm();
  }
  flat[0] = std::sqrt(std::max(height2 / static_cast<double>(indices.size()),
                               1e-4 * frame.spread_m[2] * frame.spread_m[2]));
  std::vector<Vector3d> starts = {flat, Vector3d(-flat[0], flat[1], flat[2])};
  if (indices.size() > 3 && frame.spread_m[0] > 1e-3 * frame.spread_m[2])
    starts.push_back(linear_start(centres, ranges, indices, frame, 3));
  return starts;
}

/// All distinct local minima from the starts, best first (or nearest to the hint first).
std::vector<RangeFix> minima(Points centres, std::span<const double> ranges,
                             std::span<const int> indices, const std::optional<Vector3d>& near_m) {
  std::vector<RangeFix> found;
  const PointSpread frame = spread_of(centres, indices);
  if (!(frame.spread_m[1] > 1e-7 * frame.spread_m[2])) return found;
  const double scale_m = frame.spread_m[2];
  for (const Vector3d& y : starts_of(centres, ranges, indices, frame)) {
    const Vector3d start = frame.mean_m + frame.axes * y;
    if (!start.allFinite()) continue;
    const auto solution =
        detail::minimise<3>(RangeResiduals{centres, ranges, indices, start, scale_m});
    if (!solution.finite()) continue;
    const RangeFix fix{start + scale_m * solution.x, solution.information(),
                       solution.cost() * scale_m * scale_m, std::nullopt, 0};
    bool known = false;
    for (const RangeFix& other : found)
      known = known || (other.position - fix.position).norm() < 1e-6 * scale_m;
    if (!known) found.push_back(fix);
  }
  std::sort(found.begin(), found.end(), [&](const RangeFix& a, const RangeFix& b) {
    if (!near_m) return a.cost < b.cost;
    return (a.position - *near_m).squaredNorm() < (b.position - *near_m).squaredNorm();
  });
  if (found.size() > 1) {
    found[0].mirror = found[1].position;
    found[0].mirror_cost = found[1].cost;
  }
  return found;
}

std::string input_fault(Points centres, std::span<const double> ranges,
                        const MultilaterationOptions& options) {
  if (centres.size() != ranges.size()) return "there must be one range per centre";
  const bool three_do = options.near_m && options.sigma_m;
  if (centres.size() < 3 || (centres.size() == 3 && !three_do))
    return "fewer than 4 ranges (3 where the noise and the side are stated)";
  if (options.sigma_m && !(*options.sigma_m > 0)) return "the stated noise must be positive";
  if (options.near_m && !options.near_m->allFinite()) return "the hint is not finite";
  for (std::size_t i = 0; i < centres.size(); ++i)
    if (!centres[i].allFinite() || !std::isfinite(ranges[i]) || ranges[i] < 0)
      return "measurement " + std::to_string(i) + " is not a finite point with a range >= 0";
  return {};
}

/// Ranges constrain the point to a sphere about its centres: an error e across the line of sight
/// moves it e^2 / 2r nearer along it. Adds the second moment of that, which matters for far points.
Matrix3d with_curvature(const Matrix3d& covariance, const Vector3d& arm, double radius_m) {
  const Vector3d along = arm.normalized();
  const Matrix3d side = Matrix3d::Identity() - along * along.transpose();
  const Matrix3d across = side * covariance * side;
  const double moment = across.trace() * across.trace() + 2 * across.squaredNorm();
  return covariance + moment / (4 * radius_m * radius_m) * along * along.transpose();
}

/// Why the fix cannot be trusted although it fits, empty if it can.
std::string side_fault(const RangeFix& fix, const PointSpread& frame, double sigma_m,
                       std::size_t count, const MultilaterationOptions& options) {
  // A height h over the plane of the centres changes a range r by h^2 / 2r only. Noise of z
  // standard deviations therefore moves a point of the plane by up to sqrt(2 z) of this blur: here
  // z = 3.5. If the centres spread across the plane by more than the blur, they determine the
  // height.
  const double height_m = std::abs(frame.axes.col(0).dot(fix.position - frame.mean_m));
  const double range_m = (fix.position - frame.mean_m).norm() + frame.spread_m[2];
  const double blur_m = std::sqrt(sigma_m * range_m / std::sqrt(static_cast<double>(count)));
  if (frame.spread_m[0] < blur_m && height_m < std::sqrt(7.0) * blur_m)
    return "the point lies in the plane of its centres: its height is unknown";
  // The data do not rule out a second solution within 3 sigma of likelihood.
  if (fix.mirror && !options.near_m && fix.mirror_cost - fix.cost < 9 * sigma_m * sigma_m)
    return "the centres lie in one plane: two mirrored solutions fit (say on which side)";
  return {};
}

}  // namespace

Estimate<Vector3d> multilaterate(Points centres_m, std::span<const double> ranges_m,
                                 const MultilaterationOptions& options) {
  using Answer = Estimate<Vector3d>;
  if (auto fault = input_fault(centres_m, ranges_m, options); !fault.empty())
    return Answer::degenerate(fault);
  const int n = static_cast<int>(centres_m.size());
  const double unit = options.sigma_m ? 1.0 / *options.sigma_m : 1.0;
  const auto solve = [&](std::span<const int> indices) {
    return minima(centres_m, ranges_m, indices, options.near_m);
  };
  const auto fit = [&](std::span<const int> indices) -> std::optional<RangeFix> {
    const auto all = solve(indices);
    return all.empty() ? std::nullopt : std::optional(all.front());
  };
  const auto cost = [&](const RangeFix& fix, int i) {
    const double residual = unit * ((fix.position - centres_m[i]).norm() - ranges_m[i]);
    return residual * residual;
  };
  auto found =
      fit_with_consensus<RangeFix>({n, 3, 1, 3}, options.sigma_m.has_value(), fit, solve, cost);
  std::vector<int> everything(n);
  std::iota(everything.begin(), everything.end(), 0);
  const PointSpread frame = spread_of(centres_m, found.model ? found.inliers : everything);
  if (!(frame.spread_m[1] > 1e-7 * frame.spread_m[2]))
    return Answer::degenerate("the centres lie on one line: a whole circle fits");
  if (!found.model) return Answer::degenerate(found.reason);
  const RangeFix& fix = *found.model;
  const auto sigma_m =
      noise_sigma(options.sigma_m, found.cost, static_cast<int>(found.inliers.size()) - 3,
                  1e-15 * (fix.position.norm() + frame.spread_m[2]));
  if (!sigma_m) return Answer::degenerate("too few ranges to estimate their noise: state it");
  if (frame.spread_m[1] < 5 * *sigma_m)
    return Answer::degenerate("the centres lie on one line to within their noise");
  if (auto fault = side_fault(fix, frame, *sigma_m, found.inliers.size(), options); !fault.empty())
    return Answer::degenerate(fault);
  const double extent_m = (fix.position - frame.mean_m).norm() + frame.spread_m[2];
  const auto judged = judge(fix.information / (*sigma_m * *sigma_m), Vector3d::Constant(extent_m));
  if (judged.verdict.standing == Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Eigen::VectorXd residuals(n);
  for (int i = 0; i < n; ++i) residuals[i] = (fix.position - centres_m[i]).norm() - ranges_m[i];
  return {fix.position, with_curvature(judged.covariance, fix.position - frame.mean_m, extent_m),
          std::move(residuals), std::move(found.inliers), judged.verdict};
}

Result<Vector3d> multilaterate_linear(Points centres_m, std::span<const double> ranges_m,
                                      int reference) {
  const int n = static_cast<int>(centres_m.size());
  if (n < 4 || ranges_m.size() != centres_m.size() || reference < 0 || reference >= n)
    return Error{ErrorCode::kData, "the linear solution needs 4 spheres, one the reference"};
  const Vector3d& origin = centres_m[reference];
  Eigen::MatrixXd a(n - 1, 3);
  Eigen::VectorXd b(n - 1);
  for (int i = 0, row = 0; i < n; ++i) {
    if (i == reference) continue;
    const Vector3d arm = centres_m[i] - origin;
    a.row(row) = 2 * arm.transpose();
    b[row++] =
        arm.squaredNorm() + ranges_m[reference] * ranges_m[reference] - ranges_m[i] * ranges_m[i];
  }
  const LinearFit fit = solve_linear(a, b);
  if (!a.allFinite() || !b.allFinite() || fit.rank < 3)
    return Error{ErrorCode::kData, "the spheres' centres lie in one plane: no linear solution"};
  return Vector3d(origin + fit.x);
}

}  // namespace mixrig::estimation
