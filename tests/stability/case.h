// SPDX-License-Identifier: Apache-2.0
// Runs an estimator many times on one case and checks the results.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "host/math/estimation/verdict.h"
#include "tests/stability/reference.h"

namespace mixrig::estimation_bench {

/// One noisy run: the verdict and, where there is an answer, its error.
struct Trial {
  estimation::Verdict verdict;
  Eigen::VectorXd error;       ///< estimate against truth, in the estimator's error parameters
  Eigen::MatrixXd covariance;  ///< as stated by the estimator
  double micros = 0;
};

enum class Expect {
  kAnswer,   ///< ok or weak in every trial; efficient and consistent
  kRobust,   ///< ok or weak in every trial, not overconfident: an outlier is left out
  kCareful,  ///< an answer or a refusal, but no overconfident answer: the border to degeneracy
  kRefusal   ///< degenerate in every trial
};

/// A case: `trial(seed, residuals)` makes data from the seed, runs the estimator, and (where it is
/// to be compared with bound and reference) sets `residuals` to the whitened model of its data.
struct Case {
  std::string estimator, name;
  Expect expect = Expect::kAnswer;
  std::function<Trial(std::uint64_t seed, Residuals& residuals)> trial;
  std::string axis = {};  ///< name of the parameter `at` in a sweep into a degeneracy
  double at = NAN;
};

/// Adds cases of one estimator, whose scenes differ from `Scene{}` as their names say.
template <typename Scene>
auto case_adder(std::vector<Case>& cases, const std::string& estimator,
                Trial (*run)(const Scene&, std::uint64_t, Residuals&)) {
  return [&cases, estimator, run](const std::string& name, Expect expect, const Scene& scene,
                                  const std::string& axis = {}, double at = NAN) {
    cases.push_back({estimator, name, expect,
                     [scene, run](std::uint64_t seed, Residuals& r) { return run(scene, seed, r); },
                     axis, at});
  };
}
/// Number of runs. 200 trials suffice to distinguish 1.1 of the bound from 1.0.
struct Effort {
  int trials = 200;
  int referenced = 3;            ///< trials that are also solved in 50 digits
  bool bound_everywhere = true;  ///< whether cases that may be refused get a bound
  int least_dof = 0;  ///< a case that must be answered gets more trials until it has so many
};
/// Effort of the unit test: few trials, but for each case that must be answered enough to hold its
/// error to 1.1 of the bound, sqrt(1 + 3.29 sqrt(2 / dof)).
inline constexpr Effort kShortEffort{24, 1, false, 491};

/// Results of a case; NaN where a figure does not exist.
struct Row {
  std::string estimator, name, axis;
  double at = NAN;
  Expect expect = Expect::kAnswer;
  int ok = 0, weak = 0, refused = 0;
  int dof = 0;                 ///< degrees of freedom of all answers together
  double over_bound = NAN;     ///< root mean square error over the Cramer-Rao bound
  double nees = NAN;           ///< mean, per degree of freedom
  double low = 0, high = 0;    ///< 95 % interval that chance allows `nees`
  double off_reference = NAN;  ///< greatest distance to the 50-digit minimum, sigmas
  double micros = 0;           ///< median time of a call
};

Row measure(const Case& c, const Effort& effort);

/// Faults of the row, one line each. What counts as a fault depends on what is expected:
/// - a refusal: any answer; a refusal without a reason is a fault everywhere;
/// - an answer: any refusal; error over 1.1 of the bound (more where the trials are too few for
///   it); NEES outside its 99.9 % interval; over 1e-3 sigma from the minimum in 50 digits;
/// - robust: any refusal, and the faults of careful;
/// - careful: NEES over twice its 95 % limit, higher where few are answered, because the noise
///   selects them.
std::vector<std::string> faults_of(const Row& row);

/// Whether the NEES of a case that must be answered lies outside its 95 % interval, as one in
/// twenty does by chance.
bool outside_95(const Row& row);

/// Largest number of `cases` outside their interval that chance allows (97.5 % of the binomial
/// distribution).
int most_outside_95(int cases);

/// Text of a sweep's parameter, for the name of a case.
std::string shown(double value);

/// Error of a pose, 6 parameters or 7 with log scale, at a point instead of the origin: far from
/// the origin, the image of the origin is not linear in a small rotation.
struct PoseChart {
  Eigen::Vector3d centre;  ///< the point
  Eigen::Vector3d arm;     ///< the centre after the estimated rotation (times scale)
  Eigen::VectorXd error(const Eigen::VectorXd& at_origin, const Eigen::Vector3d& value_of_centre,
                        const Eigen::Vector3d& truth_of_centre) const;
  Eigen::MatrixXd covariance(const Eigen::MatrixXd& at_origin) const;
};

/// Times `call` and fills a Trial with verdict and covariance; the caller adds the error.
template <typename Call, typename Estimate>
Trial timed(Call&& call, Estimate& estimate) {
  const auto start = std::chrono::steady_clock::now();
  estimate = call();
  const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - start;
  return {estimate.verdict, {}, estimate.covariance, taken.count()};
}

}  // namespace mixrig::estimation_bench
