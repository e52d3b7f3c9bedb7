// SPDX-License-Identifier: Apache-2.0
// Robust fits: all measurements if they agree with the stated noise, else the largest subset that
// agrees, found by random sampling (Fischler and Bolles 1981) with the score of MSAC (Torr and
// Zisserman 2000).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/math/estimation/verdict.h"

namespace mixrig::estimation {

/// z of the test whether inliers contradict each other (p = 1e-7): a refusal needs more evidence
/// than the search for outliers.
inline constexpr double kContradictionZ = 5.2;

/// Sizes of an estimation problem.
struct ProblemSize {
  int measurements;  ///< number of measurements
  int sample;        ///< measurements that determine a model up to a few solutions
  int residual_dim;  ///< residuals per measurement
  int parameters;
};

/// Keeps the best of sampled models: the one with the least sum over all measurements of
/// min(cost, limit) (MSAC; with costs of 0 and 1 and limit 1, RANSAC).
template <typename Model>
class BestModel {
 public:
  BestModel(int measurements, double limit)
      : measurements_(measurements), limit_(limit), score_(limit * measurements) {}

  /// `cost(model, i)` returns the cost of measurement i; NaN counts as an outlier. The sum stops
  /// where the model can no longer win; of equal models the first is kept.
  template <typename Cost>
  void offer(const Model& model, Cost&& cost) {
    double score = 0;
    for (int i = 0; i < measurements_ && score < score_; ++i) {
      const double c = cost(model, i);
      score += c < limit_ ? c : limit_;
    }
    if (score < score_) score_ = score, model_ = model;
  }

  /// Empty until a model with an inlier was offered.
  [[nodiscard]] const std::optional<Model>& model() const { return model_; }
  /// Share of the measurements that the best model explains, 0..1; its inliers' costs reduce it.
  [[nodiscard]] double share() const { return 1.0 - score_ / (limit_ * measurements_); }

 private:
  int measurements_;
  double limit_, score_;
  std::optional<Model> model_;
};

template <typename Model>
struct ConsensusFit {
  std::optional<Model> model;
  std::vector<int> inliers;
  double cost = 0;     ///< sum of squared residuals over the inliers
  std::string reason;  ///< why there is no model
};

namespace detail {

/// Visits all k-subsets of 0..n-1 if there are at most `limit`, else `limit` random ones from a
/// fixed seed, until `visit` returns false.
template <typename Visit>
void visit_samples(int n, int k, int limit, Visit&& visit) {
  double subsets = 1;
  for (int i = 0; i < k; ++i) subsets *= static_cast<double>(n - i) / (i + 1);
  std::vector<int> sample(k);
  std::iota(sample.begin(), sample.end(), 0);
  if (subsets <= limit) {
    for (;;) {
      if (!visit(std::span<const int>(sample))) return;
      int at = k - 1;
      while (at >= 0 && sample[at] == n - k + at) --at;
      if (at < 0) return;
      ++sample[at];
      for (int i = at + 1; i < k; ++i) sample[i] = sample[i - 1] + 1;
    }
  }
  std::uint64_t state = 0x9e3779b97f4a7c15u;
  const auto next = [&state](int below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<int>((state >> 33) % static_cast<std::uint64_t>(below));
  };
  for (int trial = 0; trial < limit; ++trial) {
    for (int i = 0; i < k; ++i) {
      do sample[i] = next(n);
      while (std::find(sample.begin(), sample.begin() + i, sample[i]) != sample.begin() + i);
    }
    if (!visit(std::span<const int>(sample))) return;
  }
}

template <typename Cost, typename Model>
std::vector<int> agreeing(int n, const Model& model, Cost&& cost, double limit) {
  std::vector<int> inliers;
  for (int i = 0; i < n; ++i)
    if (cost(model, i) <= limit) inliers.push_back(i);
  return inliers;
}

/// Returns the indices of the measurements that the best sampled model explains.
template <typename Model, typename Sample, typename Cost>
std::vector<int> largest_consensus(const ProblemSize& size, Sample&& sample, Cost&& cost) {
  // If half of the measurements are good, fewer than is required, half of these trials miss a good
  // sample with probability 1e-6.
  const int max_trials =
      static_cast<int>(2 * std::log(1e-6) / std::log1p(-std::pow(0.5, size.sample)));
  const double limit = chi2_limit(size.residual_dim, kInlierZ);
  const int n = size.measurements;
  BestModel<Model> best(n, limit);
  int trials = 0;
  visit_samples(n, size.sample, max_trials, [&](std::span<const int> indices) {
    ++trials;
    for (const Model& model : sample(indices)) best.offer(model, cost);
    // Enough once a better model would have been sampled with probability 1 - 1e-6.
    return std::pow(1.0 - std::pow(best.share(), size.sample), trials) > 1e-6;
  });
  // The sampled model has the noise of its few measurements: the gate is wider here, and the
  // refit's gate removes the rest.
  constexpr double kWider = 4;
  return best.model() ? agreeing(n, *best.model(), cost, kWider * limit) : std::vector<int>{};
}

}  // namespace detail

/// Fits all measurements. If `whitened` and they disagree with their noise, fits the largest subset
/// that agrees. A subset is accepted only with two measurements more than a sample has and three
/// fifths of all measurements: half of the points are not enough, because they can lie so close to
/// a plane that a rotated camera explains them.
/// `fit(indices)` -> optional<Model> is the full least-squares fit, `sample(indices)` -> a range of
/// Models, `cost(model, i)` the squared (whitened) residual.
template <typename Model, typename Fit, typename Sample, typename Cost>
ConsensusFit<Model> fit_with_consensus(const ProblemSize& size, bool whitened, Fit&& fit,
                                       Sample&& sample, Cost&& cost) {
  const auto fit_to = [&](std::vector<int> inliers) {
    ConsensusFit<Model> result{fit(std::span<const int>(inliers)), std::move(inliers), 0, {}};
    if (!result.model) return result;
    for (int i : result.inliers) result.cost += cost(*result.model, i);
    return result;
  };
  const auto agrees = [&](const ConsensusFit<Model>& result, double z) {
    const int dof = static_cast<int>(result.inliers.size()) * size.residual_dim - size.parameters;
    if (!result.model || !std::isfinite(result.cost)) return false;
    if (!whitened) return true;
    return dof < 1 ? result.cost < 1e-6 * size.parameters : result.cost <= chi2_limit(dof, z);
  };
  std::vector<int> all(size.measurements);
  std::iota(all.begin(), all.end(), 0);
  ConsensusFit<Model> result = fit_to(std::move(all));
  if (agrees(result, kFitZ)) return result;
  if (!whitened) return {{}, {}, 0, "the measurements determine no solution"};

  const double limit = chi2_limit(size.residual_dim, kInlierZ);
  const int needed = std::max(size.sample + 2, (3 * size.measurements + 4) / 5);
  std::vector<int> inliers = size.measurements < needed
                                 ? std::vector<int>{}
                                 : detail::largest_consensus<Model>(size, sample, cost);
  for (int round = 0; round < 6; ++round) {
    if (static_cast<int>(inliers.size()) < needed) break;
    result = fit_to(inliers);
    if (!result.model) break;
    std::vector<int> next = detail::agreeing(size.measurements, *result.model, cost, limit);
    if (next == inliers && agrees(result, kContradictionZ)) return result;
    inliers = std::move(next);
  }
  if (static_cast<int>(inliers.size()) >= needed) {
    result = fit_to(inliers);
    if (agrees(result, kContradictionZ)) return result;
  }
  return {{},
          {},
          0,
          "the measurements contradict each other by more than their stated noise, and too few "
          "of them agree (" +
              std::to_string(inliers.size()) + " of " + std::to_string(size.measurements) +
              ", needed " + std::to_string(needed) + ")"};
}

}  // namespace mixrig::estimation
