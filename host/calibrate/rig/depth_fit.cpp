// SPDX-License-Identifier: Apache-2.0
// The systematic error of a depth camera.
#include "host/calibrate/rig/depth_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "hal/base/order_statistics.h"
#include "host/calibrate/rig/rig_model.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::calibration {
namespace {

constexpr int kLeastDepthViews = 4, kMostFolds = 8, kPlace = 5;
constexpr double kHuber_m = 0.01;

/// Evenly spaced knots over the distances; the outermost 0.5 % of the samples lie outside.
std::vector<double> knots_for(std::vector<double> distances, int count) {
  const std::size_t margin = distances.size() / 200;
  const double low = order_statistic(std::span(distances), margin);
  const double high = order_statistic(std::span(distances), distances.size() - 1 - margin);
  std::vector<double> knots;
  for (int k = 0; k < count; ++k) knots.push_back(low + (high - low) * k / (count - 1));
  return knots;
}

/// Rows of the linear model: spline, amplitude, place.
class Terms {
 public:
  Terms(const DepthChoice& choice, std::vector<double> knots)
      : choice_(choice), knots_(std::move(knots)) {
    for (int i = 0; i <= kTable; ++i) {
      Eigen::VectorXd values;
      spline_basis(knots_, distance(i), values);
      table_.push_back(values);
    }
  }
  int count() const {
    return static_cast<int>(knots_.size()) + (choice_.amplitude ? 1 : 0) +
           (choice_.place ? kPlace : 0);
  }
  Eigen::VectorXd row(const DepthSample& s) const {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(count());
    int at = static_cast<int>(knots_.size());
    const double place =
        std::clamp((s.measured_m - distance(0)) / (distance(1) - distance(0)), 0.0, kTable - 1e-9);
    const auto i = static_cast<std::size_t>(place);
    const double t = place - static_cast<double>(i);
    row.head(at) = (1 - t) * table_[i] + t * table_[i + 1];
    if (choice_.amplitude) row[at++] = s.amplitude > 0 ? 1 / s.amplitude : 0;
    const double u = s.place.x(), v = s.place.y();
    if (choice_.place) row.segment<kPlace>(at) << u, v, u * u, u * v, v * v;
    return row;
  }
  const std::vector<double>& knots() const { return knots_; }

 private:
  static constexpr int kTable = 512;
  double distance(int i) const {
    return knots_.front() - 0.1 + (knots_.back() - knots_.front() + 0.2) * i / kTable;
  }
  DepthChoice choice_;
  std::vector<double> knots_;
  std::vector<Eigen::VectorXd> table_;
};

struct Solution {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

/// Two rounds, the second with outliers weighted down. A weak prior on the differences of
/// neighbouring knots regularises pieces without samples.
template <typename Use>
Solution solve(const Terms& terms, const std::vector<DepthSample>& samples,
               const std::vector<Eigen::VectorXd>& rows, Use&& use) {
  const int n = terms.count(), knots = static_cast<int>(terms.knots().size());
  Solution solution{Eigen::VectorXd::Zero(n), {}};
  for (int round = 0; round < 2; ++round) {
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n);
    double squares = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!use(samples[i])) continue;
      const double value = samples[i].measured_m - samples[i].board_m;
      const double miss = std::abs(value - rows[i].dot(solution.values));
      const double weight =
          samples[i].weight * (round > 0 && miss > kHuber_m ? kHuber_m / miss : 1);
      h.selfadjointView<Eigen::Lower>().rankUpdate(rows[i], weight);
      g += weight * value * rows[i];
      squares += weight * miss * miss;
    }
    h = Eigen::MatrixXd(h.selfadjointView<Eigen::Lower>());
    const double pull = 1e-5 * h.trace() / n;
    for (int k = 0; k + 1 < knots; ++k) {
      h(k, k) += pull, h(k + 1, k + 1) += pull;
      h(k, k + 1) -= pull, h(k + 1, k) -= pull;
    }
    h.diagonal() *= 1 + 1e-12;
    const estimation::SymmetricSolver factor(h);
    solution.values = factor.solve(g);
    solution.covariance = factor.solve(Eigen::MatrixXd::Identity(n, n)) *
                          (squares / static_cast<double>(samples.size()));
  }
  return solution;
}

double rms(const std::vector<DepthSample>& samples, const std::vector<double>& misses) {
  double squares = 0, weights = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    squares += samples[i].weight * misses[i] * misses[i], weights += samples[i].weight;
  return std::sqrt(squares / weights);
}

std::vector<Eigen::VectorXd> rows_of(const Terms& terms, const std::vector<DepthSample>& samples) {
  std::vector<Eigen::VectorXd> rows;
  for (const DepthSample& s : samples) rows.push_back(terms.row(s));
  return rows;
}

/// Weighted squared residuals of each view while it is held out.
std::vector<double> held_out(const Terms& terms, const std::vector<DepthSample>& samples,
                             const std::vector<int>& fold_of_view) {
  const auto rows = rows_of(terms, samples);
  std::vector<double> squares(fold_of_view.size(), 0.0);
  const int folds = 1 + *std::max_element(fold_of_view.begin(), fold_of_view.end());
  for (int fold = 0; fold < folds; ++fold) {
    const auto mine = [&](const DepthSample& s) { return fold_of_view[s.view] == fold; };
    const Solution fit =
        solve(terms, samples, rows, [&](const DepthSample& s) { return !mine(s); });
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const DepthSample& s = samples[i];
      if (mine(s))
        squares[s.view] +=
            s.weight * std::pow(s.measured_m - s.board_m - rows[i].dot(fit.values), 2);
    }
  }
  return squares;
}

/// Excess error of a choice over the best one, divided by the scatter of that excess over views.
double excess(const std::vector<double>& choice, const std::vector<double>& best, double views) {
  double sum = 0, squares = 0;
  for (std::size_t v = 0; v < choice.size(); ++v) {
    const double more = choice[v] - best[v];
    sum += more, squares += more * more;
  }
  const double scatter =
      std::sqrt(std::max(squares - sum * sum / views, 0.0) * views / (views - 1));
  return sum / std::max(scatter, 1e-30);
}

/// Share of the distance that the error grows by, both along a line of its own and along one
/// through zero: an offset shows in the second alone, a swing of the error in the first.
double stretch_of(const std::vector<DepthSample>& samples) {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const DepthSample& s : samples) {
    const double e = s.measured_m - s.board_m;
    w += s.weight, x += s.weight * s.board_m, y += s.weight * e;
    xx += s.weight * s.board_m * s.board_m, xy += s.weight * s.board_m * e;
  }
  const double free = (w * xy - x * y) / (w * xx - x * x), through_zero = xy / xx;
  if (free * through_zero <= 0) return 0;
  return std::abs(free) < std::abs(through_zero) ? free : through_zero;
}

}  // namespace

Result<DepthFit> fit_depth_error(const std::vector<DepthSample>& samples) {
  std::set<int> views;
  std::vector<double> distances, errors;
  for (const DepthSample& s : samples) {
    views.insert(s.view);
    distances.push_back(s.measured_m), errors.push_back(s.measured_m - s.board_m);
  }
  const auto refuse = [](const std::string& what) {
    return Error{ErrorCode::kData, "the depth error cannot be found: " + what};
  };
  if (views.size() < kLeastDepthViews || samples.size() < 50)
    return refuse("the depth camera sees the board in " + std::to_string(views.size()) +
                  " views: hold it before the camera at least " + std::to_string(kLeastDepthViews) +
                  " times, at all distances");
  const auto [low, high] = std::minmax_element(distances.begin(), distances.end());
  if (*high - *low < 0.1)
    return refuse("all views are at one distance (" + std::to_string(*low) + " to " +
                  std::to_string(*high) + " m): hold the board near and far");
  std::vector<int> fold_of_view(static_cast<std::size_t>(*views.rbegin()) + 1, 0);
  const int folds = std::min(kMostFolds, static_cast<int>(views.size()));
  int next = 0;
  for (const int view : views) fold_of_view[view] = next++ % folds;

  DepthFit fit;
  fit.uncorrected_m = rms(samples, errors);
  fit.stretch = stretch_of(samples);
  double weights = 0;
  for (const DepthSample& s : samples) weights += s.weight;
  std::vector<std::vector<double>> left;
  for (const int knots : {2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 17, 20})
    for (const bool amplitude : {false, true})
      for (const bool place : {false, true}) {
        DepthChoice choice{knots, amplitude, place};
        left.push_back(held_out(Terms(choice, knots_for(distances, knots)), samples, fold_of_view));
        choice.held_out_m =
            std::sqrt(std::accumulate(left.back().begin(), left.back().end(), 0.0) / weights);
        fit.tried.push_back(choice);
      }
  const auto size = [](const DepthChoice& c) {
    return c.knots + (c.amplitude ? 1 : 0) + (c.place ? kPlace : 0);
  };
  const auto best = std::min_element(
      fit.tried.begin(), fit.tried.end(),
      [](const DepthChoice& a, const DepthChoice& b) { return a.held_out_m < b.held_out_m; });
  const std::vector<double>& least = left[static_cast<std::size_t>(best - fit.tried.begin())];
  fit.chosen = *best;
  for (std::size_t i = 0; i < left.size(); ++i)
    if (size(fit.tried[i]) < size(fit.chosen) &&
        excess(left[i], least, static_cast<double>(views.size())) <= 1)
      fit.chosen = fit.tried[i];

  const Terms terms(fit.chosen, knots_for(distances, fit.chosen.knots));
  const auto rows = rows_of(terms, samples);
  const Solution solution = solve(terms, samples, rows, [](const DepthSample&) { return true; });
  for (std::size_t i = 0; i < samples.size(); ++i) errors[i] -= rows[i].dot(solution.values);
  calibration_file::DepthError& e = fit.error;
  e.knots_m = terms.knots();
  e.error_m.assign(solution.values.data(), solution.values.data() + e.knots_m.size());
  int at = static_cast<int>(e.knots_m.size());
  const int all = at + 1 + kPlace, knots = at;
  std::vector<int> to;
  for (int i = 0; i < knots; ++i) to.push_back(i);
  if (fit.chosen.amplitude) e.amplitude_m = solution.values[at++], to.push_back(knots);
  for (int i = 0; fit.chosen.place && i < kPlace; ++i)
    e.place_m[static_cast<std::size_t>(i)] = solution.values[at++], to.push_back(knots + 1 + i);
  e.covariance = Eigen::MatrixXd::Zero(all, all);
  for (std::size_t i = 0; i < to.size(); ++i)
    for (std::size_t j = 0; j < to.size(); ++j)
      e.covariance(to[i], to[j]) = solution.covariance(i, j);
  e.residual_m = rms(samples, errors);
  return fit;
}

}  // namespace mixrig::calibration
