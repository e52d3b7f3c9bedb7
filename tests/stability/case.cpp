// SPDX-License-Identifier: Apache-2.0
#include "tests/stability/case.h"

#include <algorithm>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "hal/base/order_statistics.h"

namespace mixrig::estimation_bench {
namespace {

constexpr int kMostTrials = 600;

double quadratic(const Eigen::VectorXd& e, const Eigen::MatrixXd& covariance) {
  // The matrix is scaled to unit diagonal: covariances mix radians and (far from the origin)
  // kilometres.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd c = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::VectorXd s = scale.asDiagonal() * e;
  return s.dot(c.ldlt().solve(s));
}

/// Seed of a case: FNV-1a of its names. Every case has its own noise, so that outcomes are
/// independent.
std::uint64_t seed_of(const Case& c) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char letter : c.estimator + c.name)
    hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3u;
  return hash;
}

/// Sums over the answers of a case.
struct Sums {
  double over_bound = 0, nees = 0;
  int answers = 0, compared = 0, referenced = 0;
  Eigen::Index dof = 0;
};

void compare(const Trial& t, const Residuals& residuals, const Effort& effort, Sums& sums,
             Row& row) {
  const int dof = static_cast<int>(t.error.size());
  const Eigen::MatrixXd bound = cramer_rao(residuals, dof);
  sums.over_bound += quadratic(t.error, bound);
  ++sums.compared;
  if (sums.referenced++ >= effort.referenced) return;
  const double off = std::sqrt(quadratic(t.error - minimum(residuals, dof), bound));
  row.off_reference = std::isnan(row.off_reference) ? off : std::max(row.off_reference, off);
}

}  // namespace

Eigen::VectorXd PoseChart::error(const Eigen::VectorXd& at_origin,
                                 const Eigen::Vector3d& value_of_centre,
                                 const Eigen::Vector3d& truth_of_centre) const {
  Eigen::VectorXd at_centre = at_origin;
  at_centre.segment<3>(3) = value_of_centre - truth_of_centre;
  return at_centre;
}

Eigen::MatrixXd PoseChart::covariance(const Eigen::MatrixXd& at_origin) const {
  Eigen::MatrixXd map = Eigen::MatrixXd::Identity(at_origin.rows(), at_origin.rows());
  map.block<3, 3>(3, 0) = -estimation::skew(arm);
  if (map.rows() == 7) map.block<3, 1>(3, 6) = arm;
  return map * at_origin * map.transpose();
}

std::string shown(double value) { return fmt::format("{:g}", value); }

Row measure(const Case& c, const Effort& effort) {
  Row row{.estimator = c.estimator, .name = c.name, .axis = c.axis, .at = c.at, .expect = c.expect};
  Sums sums;
  std::vector<double> micros;
  const std::uint64_t first_seed = seed_of(c);
  const auto wanted = [&](int i) {
    if (i < effort.trials) return true;
    return c.expect == Expect::kAnswer && i < kMostTrials &&
           sums.answers * sums.dof < effort.least_dof;
  };
  for (int i = 0; wanted(i); ++i) {
    Residuals residuals;
    const Trial t = c.trial(first_seed + i, residuals);
    micros.push_back(t.micros);
    if (t.verdict.standing == estimation::Standing::kDegenerate) {
      ++row.refused;
      continue;
    }
    ++(t.verdict.standing == estimation::Standing::kOk ? row.ok : row.weak);
    ++sums.answers;
    sums.dof = t.error.size();
    sums.nees += quadratic(t.error, t.covariance);
    if (residuals && (effort.bound_everywhere || c.expect == Expect::kAnswer))
      compare(t, residuals, effort, sums, row);
  }
  row.micros = upper_median_in_place(std::span(micros));
  if (sums.answers == 0) return row;
  row.dof = sums.answers * static_cast<int>(sums.dof);
  row.nees = sums.nees / row.dof;
  if (sums.compared > 0)
    row.over_bound = std::sqrt(sums.over_bound / (sums.compared * static_cast<double>(sums.dof)));
  row.low = estimation::chi2_limit(row.dof, -1.96) / row.dof;
  row.high = estimation::chi2_limit(row.dof, 1.96) / row.dof;
  return row;
}

std::vector<std::string> faults_of(const Row& row) {
  std::vector<std::string> faults;
  const auto fault = [&](const std::string& what) {
    faults.push_back(row.estimator + ", " + row.name + ": " + what);
  };
  const int answers = row.ok + row.weak;
  if (row.expect == Expect::kRefusal) {
    if (answers > 0) fault(std::to_string(answers) + " confident answers to what has none");
    return faults;
  }
  if (row.expect == Expect::kRobust && row.refused > 0)
    fault(std::to_string(row.refused) + " refusals of what can be answered");
  if (row.expect == Expect::kCareful || row.expect == Expect::kRobust) {
    // Noise that lets one in p trials through to an answer has by itself -2 ln p of chi-squared.
    const double share = static_cast<double>(answers) / (answers + row.refused);
    const double chosen = answers > 0 ? -2 * std::log(share) * answers / row.dof : 0;
    const double limit = 2 * (row.high + chosen);
    if (row.nees >= limit)
      fault(fmt::format("overconfident, NEES {:.2f} over {:.2f}", row.nees, limit));
    return faults;
  }
  if (row.refused > 0) fault(std::to_string(row.refused) + " refusals of what can be answered");
  if (answers == 0) return faults;
  constexpr double kZ = 3.29;  // two-sided 99.9 %
  const double low = estimation::chi2_limit(row.dof, -kZ) / row.dof;
  const double high = estimation::chi2_limit(row.dof, kZ) / row.dof;
  const double efficient = std::max(1.1, std::sqrt(high));
  if (!(row.over_bound <= efficient))
    fault(fmt::format("error {:.3f} of the Cramer-Rao bound, limit {:.3f}", row.over_bound,
                      efficient));
  if (!(row.nees >= low)) fault(fmt::format("too modest, NEES {:.3f} under {:.3f}", row.nees, low));
  if (!(row.nees <= high))
    fault(fmt::format("overconfident, NEES {:.3f} over {:.3f}", row.nees, high));
  if (!(row.off_reference < 1e-3))
    fault(fmt::format("{:.1e} sigma from the minimum in 50 digits, limit {:.0e}", row.off_reference,
                      1e-3));
  return faults;
}

bool outside_95(const Row& row) {
  return row.expect == Expect::kAnswer && row.dof > 0 &&
         !(row.nees >= row.low && row.nees <= row.high);
}

int most_outside_95(int cases) {
  double probability = std::pow(0.95, cases), sum = probability;
  int most = 0;
  for (; sum < 0.975 && most < cases; ++most) {
    probability *= (cases - most) / (most + 1.0) * 0.05 / 0.95;
    sum += probability;
  }
  return most;
}

}  // namespace mixrig::estimation_bench
