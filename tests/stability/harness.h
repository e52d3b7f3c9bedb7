// SPDX-License-Identifier: Apache-2.0
// Runs an estimator many times through one case and holds it to what was expected.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "host/estimation/verdict.h"
#include "tests/stability/reference.h"

namespace mixrig::stability {

/// One noisy run: the verdict and, where there is an answer, its error.
struct Trial {
  estimation::Verdict verdict;
  Eigen::VectorXd error;       ///< in the estimator's error parameters
  Eigen::MatrixXd covariance;  ///< as claimed
  double micros = 0;
};

enum class Expect {
  kAnswer,   ///< ok or weak in every trial; efficient and consistent
  kCareful,  ///< an answer or a refusal, but no overconfident answer: the border of the degenerate
  kRefusal   ///< degenerate in every trial
};

/// A case: `trial(seed, residuals)` makes data from the seed, runs the estimator, and (where it is
/// to be compared with bound and reference) sets `residuals` to the whitened model of its data.
struct Case {
  std::string estimator, name;
  Expect expect = Expect::kAnswer;
  std::function<Trial(std::uint64_t seed, Residuals& residuals)> trial;
  int trials = 100;
};

/// Runs the case, adds its line to the table and checks:
/// kAnswer: error over Cramer-Rao bound <= 1.1, NEES inside its 95 % interval, distance to the
/// 50-digit minimum < 1e-3 sigma. kCareful: NEES of the answers below twice its upper limit.
void check(const Case& c);

/// Times `call` and fills a Trial with verdict and covariance; the caller adds the error.
template <typename Call>
Trial timed(Call&& call, auto& estimate) {
  const auto start = std::chrono::steady_clock::now();
  estimate = call();
  const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - start;
  return {estimate.verdict, {}, estimate.covariance, taken.count()};
}

}  // namespace mixrig::stability
