// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/points/rigid_fit.h"

#include <array>
#include <cmath>

#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::estimation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Points = std::span<const Vector3d>;

/// First and second moments of the weighted points.
struct PairMoments {
  Vector3d mean_a = Vector3d::Zero(), mean_b = Vector3d::Zero();
  Matrix3d scatter_a = Matrix3d::Zero();  // sum of w a a^T about the mean
  Matrix3d cross = Matrix3d::Zero();      // sum of w b a^T about the means
  double weight = 0, trace_b = 0;         // trace: sum of w |b - mean|^2
};

PairMoments moments_of(Points a, Points b, std::span<const double> weights,
                       std::span<const int> indices) {
  PairMoments m;
  const auto weight = [&](int i) { return weights.empty() ? 1.0 : weights[i]; };
  // Means of differences to one point: no precision is lost far from the origin.
  const Vector3d a0 = a[indices[0]], b0 = b[indices[0]];
  for (int i : indices) {
    m.weight += weight(i);
    m.mean_a += weight(i) * (a[i] - a0);
    m.mean_b += weight(i) * (b[i] - b0);
  }
  m.mean_a = a0 + m.mean_a / m.weight;
  m.mean_b = b0 + m.mean_b / m.weight;
  for (int i : indices) {
    const Vector3d da = a[i] - m.mean_a;
    m.scatter_a += weight(i) * da * da.transpose();
    m.cross += weight(i) * (b[i] - m.mean_b) * da.transpose();
    m.trace_b += weight(i) * (b[i] - m.mean_b).squaredNorm();
  }
  return m;
}

struct Solution {
  Similarity transform;
  PairMoments moments;
  Vector3d singular_values;  // of the cross moments
  bool mirrored;             // the best orthogonal matrix is a reflection
};

std::optional<Solution> solve(Points a, Points b, std::span<const double> weights,
                              std::span<const int> indices, bool with_scale) {
  if (indices.size() < 3) return std::nullopt;
  Solution s{{}, moments_of(a, b, weights, indices), {}, false};
  if (!s.moments.cross.allFinite() || !(s.moments.scatter_a.trace() > 0)) return std::nullopt;
  const RotationFit turn = fit_rotation(s.moments.cross);
  s.singular_values = turn.singular_values;
  s.mirrored = turn.mirrored;
  const Vector3d sign(1, 1, s.mirrored ? -1 : 1);
  Similarity& t = s.transform;
  t.pose.rotation = turn.rotation;
  if (with_scale) t.scale = s.singular_values.dot(sign) / s.moments.scatter_a.trace();
  t.pose.translation_m = s.moments.mean_b - t.scale * (t.pose.rotation * s.moments.mean_a);
  if (!(t.scale > 0)) return std::nullopt;
  return s;
}

/// Whether a reflection fits far better than the best rotation.
bool is_mirror_image(const Solution& s) {
  const double scale = s.transform.scale;
  const double mirror_cost = scale * scale * s.moments.scatter_a.trace() + s.moments.trace_b -
                             2 * scale * s.singular_values.sum();
  const double rotation_cost = mirror_cost + 4 * scale * s.singular_values[2];
  return s.mirrored && mirror_cost < 0.1 * rotation_cost &&
         rotation_cost > 1e-6 * s.moments.trace_b;
}

/// Why the points do not determine a rotation, empty if they do. `sigma_m`: noise of a point of b.
std::string shape_fault(const Solution& s, double sigma_m) {
  const Vector3d variance = spectrum_of(s.moments.scatter_a).values.cwiseMax(0) / s.moments.weight;
  const Vector3d spread = s.transform.scale * variance.cwiseSqrt();
  if (spread[2] <= 0) return "all points coincide";
  if (spread[1] <= 1e-7 * spread[2])
    return "the points lie on one line: the rotation about it is unknown";
  if (is_mirror_image(s)) return "the sets are mirror images of each other: one axis is negated";
  if (sigma_m > 0.3 * spread[2]) return "the sets do not match: residuals as large as the sets";
  if (spread[1] < 5 * sigma_m)
    return "the points lie on one line to within their noise: the rotation about it is unknown";
  return {};
}

/// Information at the centroid; parameters rotation, translation, log scale.
Eigen::MatrixXd information_of(const Solution& s, double sigma_m, bool with_scale) {
  const int n = with_scale ? 7 : 6;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  const Matrix3d r = s.transform.pose.rotation.toRotationMatrix();
  const Matrix3d scatter =
      s.transform.scale * s.transform.scale * (r * s.moments.scatter_a * r.transpose());
  information.topLeftCorner<3, 3>() = scatter.trace() * Matrix3d::Identity() - scatter;
  information.block<3, 3>(3, 3) = s.moments.weight * Matrix3d::Identity();
  if (with_scale) information(6, 6) = scatter.trace();
  return information / (sigma_m * sigma_m);
}

/// Covariance of (rotation, translation at the origin of a, log scale) from that at the centroid.
Eigen::MatrixXd at_origin(const Eigen::MatrixXd& at_centroid, const Solution& s) {
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(at_centroid.rows(), at_centroid.rows());
  const Vector3d arm = s.transform.scale * (s.transform.pose.rotation * s.moments.mean_a);
  map.block<3, 3>(3, 0) = skew(arm);
  if (map.rows() == 7) map.block<3, 1>(3, 6) = -arm;
  return map * at_centroid * map.transpose();
}

std::string input_fault(Points a, Points b, const RigidFitOptions& options) {
  if (a.size() != b.size()) return "the two sets differ in size";
  if (a.size() < 3) return "fewer than 3 points";
  if (!options.weights.empty() && options.weights.size() != a.size())
    return "there must be one weight per point";
  if (options.sigma_m && !(*options.sigma_m > 0)) return "the stated noise must be positive";
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!a[i].allFinite() || !b[i].allFinite())
      return "point " + std::to_string(i) + " is not finite";
  for (double w : options.weights)
    if (!(w > 0) || !std::isfinite(w)) return "weights must be positive and finite";
  return {};
}

Estimate<Similarity> fit(Points a, Points b, const RigidFitOptions& options, bool with_scale) {
  using Answer = Estimate<Similarity>;
  if (auto fault = input_fault(a, b, options); !fault.empty()) return Answer::degenerate(fault);
  const int n = static_cast<int>(a.size()), parameters = with_scale ? 7 : 6;
  const double unit = options.sigma_m ? 1.0 / *options.sigma_m : 1.0;
  const auto weight = [&](int i) { return options.weights.empty() ? 1.0 : options.weights[i]; };
  const auto least_squares = [&](std::span<const int> indices) {
    return solve(a, b, options.weights, indices, with_scale);
  };
  const auto sample = [&](std::span<const int> indices) {
    const auto one = least_squares(indices);
    return one ? std::vector<Solution>{*one} : std::vector<Solution>{};
  };
  const auto cost = [&](const Solution& s, int i) {
    return weight(i) * unit * unit * (b[i] - s.transform * a[i]).squaredNorm();
  };
  auto found = fit_with_consensus<Solution>({n, 3, 3, parameters}, options.sigma_m.has_value(),
                                            least_squares, sample, cost);
  // If the shape of the set is the cause, the reason names it instead of a contradiction.
  std::vector<int> all(n);
  std::iota(all.begin(), all.end(), 0);
  if (!found.model) {
    const auto whole = least_squares(all);
    const auto fault = whole ? shape_fault(*whole, options.sigma_m.value_or(0)) : std::string();
    return Answer::degenerate(!whole          ? "all points coincide"
                              : fault.empty() ? found.reason
                                              : fault);
  }
  const Solution& s = *found.model;
  const int dof = 3 * static_cast<int>(found.inliers.size()) - parameters;
  const double size_m = s.moments.mean_b.norm() + std::sqrt(s.singular_values[0]);
  const auto sigma_m = noise_sigma(options.sigma_m, found.cost, dof, 1e-15 * size_m);
  if (!sigma_m) return Answer::degenerate("too few points to estimate their noise: state it");
  if (auto fault = shape_fault(s, *sigma_m); !fault.empty()) return Answer::degenerate(fault);
  const double spread_m =
      s.transform.scale * std::sqrt(s.moments.scatter_a.trace() / s.moments.weight);
  Eigen::VectorXd extent = Eigen::VectorXd::Ones(parameters);
  extent.segment<3>(3).setConstant(spread_m);
  const auto judged = judge(information_of(s, *sigma_m, with_scale), extent);
  if (judged.verdict.standing == Standing::kDegenerate)
    return Answer::degenerate(judged.verdict.reason);
  Eigen::VectorXd residuals(n);
  for (int i = 0; i < n; ++i) residuals[i] = (b[i] - s.transform * a[i]).norm();
  return {s.transform, at_origin(judged.covariance, s), std::move(residuals),
          std::move(found.inliers), judged.verdict};
}

}  // namespace

Estimate<geometry::Pose> rigid_fit(Points a_m, Points b_m, const RigidFitOptions& options) {
  auto e = fit(a_m, b_m, options, false);
  return {e.value.pose, std::move(e.covariance), std::move(e.residuals), std::move(e.inliers),
          std::move(e.verdict)};
}

Estimate<Similarity> similarity_fit(Points a_m, Points b_m, const RigidFitOptions& options) {
  return fit(a_m, b_m, options, true);
}

std::optional<geometry::Pose> align_points(Points a_m, Points b_m, std::span<const int> indices) {
  const auto s = solve(a_m, b_m, {}, indices, false);
  if (!s) return std::nullopt;
  return s->transform.pose;
}

}  // namespace mixrig::estimation
